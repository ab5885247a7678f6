"""Pictures on shapes: reading them, and laying them on shapes that do not say how."""

from __future__ import annotations

import hashlib
import io
from pathlib import Path

import msgspec
import numpy as np

from ahmss.body.array import Array
from ahmss.errors import DataError

__all__ = ["Texture", "box_projection", "read_texture"]

_MOST_BYTES, _MOST_PIXELS = 32_000_000, 4096 * 4096
_FORMATS = {"PNG": "image/png", "JPEG": "image/jpeg"}


class Texture(msgspec.Struct, frozen=True):
    """A picture as it stands in its file, with the SHA-256 of its bytes."""

    data: bytes
    hash: str
    media: str

    @classmethod
    def of(cls, data: bytes, media: str) -> Texture:
        """The texture of these bytes."""
        return cls(data, hashlib.sha256(data).hexdigest(), media)


def read_texture(path: Path, label: str) -> Texture:
    """A PNG or JPEG file.

    Raises:
        DataError: missing, of another kind, broken, or too large.
    """
    from PIL import Image  # not needed where a shape comes out of the store

    try:
        if path.stat().st_size > _MOST_BYTES:
            raise DataError(label, "", f"larger than {_MOST_BYTES // 1_000_000} MB; make the picture smaller")
        data = path.read_bytes()
    except FileNotFoundError:
        raise DataError(label, "", "no such file") from None
    except OSError as error:
        raise DataError(label, "", f"can't be read: {error.strerror}") from None
    try:
        with Image.open(io.BytesIO(data), formats=list(_FORMATS)) as image:
            if image.width * image.height > _MOST_PIXELS:
                raise DataError(label, "", f"{image.width} x {image.height} pixels; at most {_MOST_PIXELS:,} in all")
            image.load()
            return Texture.of(data, _FORMATS[str(image.format)])
    except (OSError, SyntaxError, ValueError, Image.DecompressionBombError):
        raise DataError(label, "", "no PNG or JPEG picture that can be read") from None


def box_projection(triangles: Array, size: float) -> Array:
    """Picture coordinates (n, 3, 2) of triangles (n, 3, 3): each is seen from the axis that it faces most.

    Pictures stand upright on the sides (up is z) and are seen from outside, not mirrored. With `size` 0 the picture
    spans the triangles' bounds once, else it repeats every `size` metres.
    """
    normals = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    axis = np.argmax(np.abs(normals), axis=1)
    positive = np.take_along_axis(normals, axis[:, None], axis=1)[:, 0] > 0.0
    # (picture's right, picture's up) for +x, -x, +y, -y, +z, -z: coordinate and sign.
    right = np.array([1, 1, 0, 0, 0, 0])[2 * axis + ~positive]
    right_sign = np.array([1.0, -1.0, -1.0, 1.0, 1.0, 1.0])[2 * axis + ~positive]
    up = np.array([2, 2, 2, 2, 1, 1])[2 * axis + ~positive]
    up_sign = np.array([1.0, 1.0, 1.0, 1.0, 1.0, -1.0])[2 * axis + ~positive]
    points = triangles
    if size > 0.0:
        points, span = triangles / size, np.ones(3)
        low = np.zeros(3)
    else:
        low = triangles.min(axis=(0, 1))
        span = np.maximum(triangles.max(axis=(0, 1)) - low, 1e-9)
    unit = (points - low) / span
    out = np.empty((*triangles.shape[:2], 2))
    for column, (index, sign) in enumerate(((right, right_sign), (up, up_sign))):
        value = np.take_along_axis(unit, index[:, None, None], axis=2)[..., 0]
        mirrored = 1.0 - value if size == 0.0 else -value
        out[..., column] = np.where(sign[:, None] > 0.0, value, mirrored)
    return out
