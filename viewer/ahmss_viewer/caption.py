"""Text in the picture: drawn by Pillow, shown as a flat texture."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np
import pyrender
from numpy.typing import NDArray
from PIL import Image, ImageDraw, ImageFont

__all__ = ["Flat", "Writer", "font", "render_text"]

_FONT = Path(pyrender.__file__).parent / "fonts" / "OpenSans-Regular.ttf"


@dataclass(frozen=True)
class Flat:
    """A texture at a place of the picture, pixels from the top left."""

    texture: pyrender.Texture
    left: float
    top: float
    width: int
    height: int


@lru_cache(maxsize=8)
def font(size: int) -> Any:
    """The overlay's font, in pixels; Pillow's own where pyrender brings none."""
    return ImageFont.truetype(str(_FONT), size) if _FONT.exists() else ImageFont.load_default(size)


def render_text(text: str, size: int, ink: tuple[int, int, int], paper: tuple[int, int, int, int]) -> NDArray[np.uint8]:
    """Text of several lines on a rounded plate: (h, w, 4), colours already multiplied by alpha."""
    pad = max(3, size // 3)
    left, top, right, bottom = ImageDraw.Draw(Image.new("L", (1, 1))).multiline_textbbox((0, 0), text, font=font(size))
    width, height = int(np.ceil(right - min(left, 0))) + 2 * pad, int(np.ceil(bottom - min(top, 0))) + 2 * pad
    plate = Image.new("RGBA", (width, height), (0, 0, 0, 0))
    pen = ImageDraw.Draw(plate)
    pen.rounded_rectangle((0, 0, width - 1, height - 1), radius=pad, fill=paper)
    pen.multiline_text((pad, pad - size // 8), text, font=font(size), fill=(*ink, 255))
    pixels = np.asarray(plate).astype(np.uint16)
    pixels[..., :3] = pixels[..., :3] * pixels[..., 3:] // 255
    return pixels.astype(np.uint8)


class Writer:
    """Makes texts into flats, each text once; forgets those that were not used for a while."""

    def __init__(self, size: int = 14) -> None:
        self.size = size
        self._made: dict[tuple[Any, ...], tuple[pyrender.Texture, int, int]] = {}

    def flat(
        self,
        text: str,
        left: float,
        top: float,
        *,
        size: int | None = None,
        ink: tuple[int, int, int] = (255, 255, 255),
        paper: tuple[int, int, int, int] = (30, 34, 40, 150),
        centred: bool = False,
    ) -> Flat:
        """The text with its top left (or top middle, if centred) at a place of the picture."""
        key = (text, size or self.size, ink, paper)
        if key not in self._made:
            if len(self._made) > 400:
                self._forget()
            pixels = render_text(text, size or self.size, ink, paper)
            texture = pyrender.Texture(source=np.ascontiguousarray(pixels[::-1]), source_channels="RGBA")
            self._made[key] = (texture, pixels.shape[1], pixels.shape[0])
        texture, width, height = self._made[key]
        return Flat(texture, round(left - width / 2 if centred else left), round(top), width, height)

    def _forget(self) -> None:
        """Free all textures."""
        for texture, _, _ in self._made.values():
            texture.delete()
        self._made.clear()
