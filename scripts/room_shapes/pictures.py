"""The pictures on the room's shapes, drawn from a fixed seed: planks, oak, what the television shows."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from PIL import Image, ImageDraw, ImageFilter


def write_pictures(objectdb: Path) -> None:
    """All pictures of the room."""
    _save(_planks(), objectdb / "textures" / "planks.png")
    _save(_oak(), objectdb / "textures" / "oak.png")
    _save(_landscape(), objectdb / "television" / "picture.png")
    _save(_quilt(), objectdb / "bed" / "quilt.png")
    _save(_spines(), objectdb / "bookshelf" / "spines.png")


def _save(image: Image.Image, path: Path) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    image.convert("RGB").quantize(128, dither=Image.Dither.NONE).save(path, "PNG", optimize=False)


def _noise(rng: np.random.Generator, shape: tuple[int, int], blur: tuple[float, float]) -> np.ndarray:
    """Noise of unit spread that repeats at the borders, smoothed along rows and columns by `blur` pixels."""
    field = np.fft.fft2(rng.standard_normal(shape))
    rows, columns = np.fft.fftfreq(shape[0])[:, None], np.fft.fftfreq(shape[1])[None, :]
    field *= np.exp(-2.0 * np.pi**2 * ((rows * blur[0]) ** 2 + (columns * blur[1]) ** 2))
    out = np.fft.ifft2(field).real
    return out / out.std()


def _wood(rng: np.random.Generator, shape: tuple[int, int], base: tuple[int, int, int], depth: float) -> np.ndarray:
    """Grain along the columns of the picture (upwards)."""
    fine, broad = _noise(rng, shape, (60.0, 1.0)), _noise(rng, shape, (140.0, 9.0))
    rings = np.sin(5.0 * broad + 0.6 * fine)
    tone = 1.0 + depth * (0.5 * fine + 0.7 * rings)
    return np.array(base)[None, None, :] * tone[:, :, None]


def _oak() -> Image.Image:
    pixels = _wood(np.random.default_rng(3), (512, 512), (178, 132, 84), 0.045)
    return Image.fromarray(np.clip(pixels, 0, 255).astype(np.uint8))


def _planks() -> Image.Image:
    """Four planks side by side, each of two boards, with dark joints."""
    rng = np.random.default_rng(7)
    out = np.zeros((512, 512, 3))
    for i in range(4):
        board = _wood(rng, (512, 128), (186, 160, 128), 0.03)
        joint = (97 + 211 * i) % 512
        tones = rng.uniform(0.94, 1.04, 2)
        board = np.roll(board * np.where(np.arange(512)[:, None, None] < 256, tones[0], tones[1]), joint, axis=0)
        board[[joint, (joint + 1) % 512, (joint + 256) % 512, (joint + 257) % 512]] *= 0.68
        board[:, :2] *= 0.66
        out[:, 128 * i : 128 * i + 128] = board
    return Image.fromarray(np.clip(out, 0, 255).astype(np.uint8))


def _landscape() -> Image.Image:
    """A weather map's worth of evening: sky, sun, hills and a lake."""
    width, height = 512, 320
    rows = np.linspace(0.0, 1.0, height)[:, None]
    sky = np.concatenate([80 + 150 * rows, 140 + 50 * rows, 215 - 90 * rows], axis=1)
    image = Image.fromarray(np.repeat(sky[:, None, :], width, axis=1).astype(np.uint8))
    draw = ImageDraw.Draw(image)
    draw.ellipse((330, 70, 410, 150), fill=(255, 236, 170))
    x = np.arange(width)
    hills = ((180, 38, (92, 110, 138), 0.0), (215, 26, (62, 92, 92), 2.1), (248, 14, (38, 66, 52), 4.0))
    for level, swing, color, phase in hills:
        ridge = level + swing * np.sin(x / 61.0 + phase) + 0.4 * swing * np.sin(x / 23.0 + 2 * phase)
        draw.polygon([(0, height), *zip(x.tolist(), ridge.tolist(), strict=True), (width, height)], fill=color)
    draw.polygon([(120, height), (250, 272), (420, 276), (470, height)], fill=(150, 170, 190))
    return image.filter(ImageFilter.GaussianBlur(0.8))


def _quilt() -> Image.Image:
    """Squares of a bed cover."""
    rng = np.random.default_rng(11)
    image = Image.new("RGB", (256, 256))
    draw = ImageDraw.Draw(image)
    colors = [(92, 118, 152), (126, 150, 178), (208, 214, 220), (74, 96, 128)]
    for i in range(4):
        for j in range(4):
            draw.rectangle((64 * i, 64 * j, 64 * i + 63, 64 * j + 63), fill=colors[(i + 2 * j + (i * j) % 3) % 4])
    weave = 1.0 + 0.04 * _noise(rng, (256, 256), (0.7, 0.7))
    return Image.fromarray(np.clip(np.asarray(image) * weave[:, :, None], 0, 255).astype(np.uint8))


def _spines() -> Image.Image:
    """Books side by side, their backs to the front, with bands and titles."""
    rng = np.random.default_rng(5)
    image = Image.new("RGB", (512, 512), (60, 48, 40))
    draw = ImageDraw.Draw(image)
    colors = [(126, 44, 40), (46, 70, 104), (72, 94, 66), (176, 146, 84), (74, 60, 92), (196, 186, 166), (60, 60, 64)]
    x = 0
    while x < 512:
        width = int(rng.integers(18, 40))
        color = colors[int(rng.integers(len(colors)))]
        draw.rectangle((x, 0, min(x + width, 512) - 2, 511), fill=color)
        draw.line((x, 0, x, 511), fill=tuple(int(0.7 * c) for c in color))
        light = tuple(min(255, int(1.5 * c) + 30) for c in color)
        for level in (150, 232, 380):
            draw.rectangle((x + 3, level, min(x + width, 512) - 5, level + int(rng.integers(3, 9))), fill=light)
        x += width
    return image.filter(ImageFilter.GaussianBlur(0.6))
