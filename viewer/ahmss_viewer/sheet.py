"""Contact sheets: every n-th picture of a motion on one page, which is how a person judges it on paper."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw

from ahmss.errors import DataError
from ahmss_viewer.caption import font

__all__ = ["Sheet", "Tile", "layout", "save_picture"]

_GAP, _STRIP, _HEAD = 6, 18, 30
_PAPER, _INK, _FAINT = (250, 250, 248), (30, 32, 36), (110, 112, 118)
_MOST_TILES = 400


@dataclass(frozen=True)
class Tile:
    """One picture (height, width, 3) uint8 of the frame of that number, seconds from the start."""

    picture: NDArray[np.uint8]
    frame: int
    seconds: float


def layout(count: int, tile: tuple[int, int], columns: int = 0) -> tuple[int, int]:
    """Columns and rows of a page for so many tiles, as wide as a screen where the number is not given."""
    if not columns:
        best = np.sqrt(max(count, 1) * 1.5 * (tile[1] + _STRIP + _GAP) / (tile[0] + _GAP))
        columns = int(np.clip(round(float(best)), 1, max(count, 1)))
    return columns, max(1, -(-count // columns))


@dataclass
class Sheet:
    """Collects tiles of one size."""

    title: str = ""
    columns: int = 0
    tiles: list[Tile] = field(default_factory=list[Tile])

    def add(self, picture: NDArray[np.uint8], frame: int, seconds: float) -> None:
        """Add a picture, which is copied; beyond 400 none is taken any more."""
        if len(self.tiles) < _MOST_TILES:
            self.tiles.append(Tile(picture.copy(), frame, seconds))

    def page(self) -> Image.Image:
        """The page."""
        height, width = self.tiles[0].picture.shape[:2] if self.tiles else (120, 160)
        columns, rows = layout(len(self.tiles), (width, height), self.columns)
        size = (columns * (width + _GAP) + _GAP, _HEAD + rows * (height + _STRIP + _GAP) + _GAP)
        page = Image.new("RGB", size, _PAPER)
        pen = ImageDraw.Draw(page)
        pen.text((_GAP + 2, 5), self.title, fill=_INK, font=font(15))
        for number, tile in enumerate(self.tiles):
            left = _GAP + (number % columns) * (width + _GAP)
            top = _HEAD + (number // columns) * (height + _STRIP + _GAP)
            page.paste(Image.fromarray(tile.picture), (left, top))
            pen.text((left + 2, top + height), f"frame {tile.frame}", fill=_INK, font=font(12))
            pen.text((left + width - 2, top + height), f"{tile.seconds:.2f} s", fill=_FAINT, font=font(12), anchor="ra")
        return page

    def save(self, path: Path) -> None:
        """Write the page. DataError: it can't be written here."""
        save_picture(self.page(), path)


def save_picture(picture: Image.Image | NDArray[np.uint8], path: Path) -> None:
    """Write a picture; the file's ending says the format (PNG where it says none).

    Raises:
        DataError: it can't be written here, or in this format.
    """
    image = picture if isinstance(picture, Image.Image) else Image.fromarray(np.ascontiguousarray(picture))
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        image.save(path, format=None if path.suffix else "PNG")
    except OSError as error:
        reason = error.strerror or error
        raise DataError(path, "", f"the picture can't be written: {reason}; name another file") from error
    except ValueError as error:
        raise DataError(path, "", f'"{path.suffix}" is no picture format that is known; use .png or .jpg') from error
