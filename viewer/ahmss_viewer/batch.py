"""Triangles in the graphics memory, packed to 28 bytes a vertex; a pyrender primitive."""

from __future__ import annotations

import ctypes
import io
from typing import Any

import numpy as np
from numpy.typing import NDArray
from OpenGL import GL
from PIL import Image
from pyrender import Primitive, Sampler, Texture

from ahmss_viewer.surface import Surface

__all__ = ["Batch", "open_image", "pack"]

_PLAIN = [("position", "3f4"), ("normal", "4i1"), ("colour", "4u1"), ("texcoord", "2f4")]
_SKINNED = [*_PLAIN, ("joints", "4u1"), ("weights", "4u1")]
_LARGEST_IMAGE = 2048


def pack(surface: Surface, T_world_object: NDArray[Any] | None = None) -> NDArray[Any]:
    """The vertices of a surface, placed if a matrix (4, 4) is given, as one structured array."""
    skin = surface.skin
    packed = np.zeros(len(surface.positions), _SKINNED if skin is not None else _PLAIN)
    positions, normals = surface.positions, surface.normals
    if T_world_object is not None:
        turn = T_world_object[:3, :3].T
        positions, normals = positions @ turn + T_world_object[:3, 3], normals @ turn
    packed["position"] = positions
    packed["normal"][:, :3] = np.round(127.0 * normals)
    packed["colour"] = surface.colours
    packed["colour"][:, 3] = round(255.0 * surface.lit)  # nothing is transparent: the fourth number is free
    if surface.texcoords is not None:
        packed["texcoord"] = surface.texcoords
    if skin is not None:
        packed["joints"], packed["weights"] = skin.joints, skin.weights
    return packed


def open_image(data: bytes) -> Texture | None:
    """A texture of PNG or JPEG bytes; None where they are no picture (the surface is then drawn in its colour)."""
    try:
        with Image.open(io.BytesIO(data)) as picture:
            picture.thumbnail((_LARGEST_IMAGE, _LARGEST_IMAGE))
            pixels = np.asarray(picture.convert("RGBA"))
    except (OSError, ValueError, Image.DecompressionBombError):
        return None
    # pyrender turns a picture upside down for OpenGL; glTF counts v downwards, so it is turned here once more.
    # Of the nearest mipmap only: blending two costs a tenth of the picture.
    sampler = Sampler(magFilter=GL.GL_LINEAR, minFilter=GL.GL_LINEAR_MIPMAP_NEAREST)
    return Texture(source=np.ascontiguousarray(pixels[::-1]), source_channels="RGBA", sampler=sampler)


class Batch(Primitive):
    """Vertices and faces in buffers.

    One with a skin has `influences` 1 to 4, the most links that move a vertex; `links` (43, 3, 4) float32 are theirs.
    """

    def __init__(
        self,
        vertices: NDArray[Any],
        faces: NDArray[Any],
        texture: Texture | None = None,
        *,
        influences: int = 0,
        two_sided: bool = False,
    ) -> None:
        super().__init__(positions=vertices["position"], mode=GL.GL_TRIANGLES)
        self.vertices = vertices
        self.faces = np.ascontiguousarray(faces, np.uint32)
        self.texture = texture
        self.influences = influences
        self.two_sided = two_sided
        self.links: NDArray[np.float32] = np.zeros((43, 3, 4), np.float32)
        self._vaid: Any = None

    @classmethod
    def of(cls, surface: Surface, texture: Texture | None) -> Batch:
        """A surface by itself, in its own frame."""
        influences = 0
        if surface.skin is not None:
            influences = int(np.flatnonzero(surface.skin.weights.max(axis=0)).max()) + 1
        return cls(pack(surface), surface.faces, texture, influences=influences, two_sided=surface.two_sided)

    def _add_to_context(self) -> None:
        """Upload; called by the painter when the batch is first drawn."""
        self._vaid = GL.glGenVertexArrays(1)
        GL.glBindVertexArray(self._vaid)
        self._buffers: list[Any] = [GL.glGenBuffers(1), GL.glGenBuffers(1)]
        GL.glBindBuffer(GL.GL_ARRAY_BUFFER, self._buffers[0])
        GL.glBufferData(GL.GL_ARRAY_BUFFER, self.vertices.nbytes, self.vertices, GL.GL_STATIC_DRAW)
        stride = self.vertices.dtype.itemsize
        columns = (
            (0, "position", 3, GL.GL_FLOAT, False), (1, "normal", 4, GL.GL_BYTE, True),
            (2, "colour", 4, GL.GL_UNSIGNED_BYTE, True), (3, "texcoord", 2, GL.GL_FLOAT, False),
            (5, "weights", 4, GL.GL_UNSIGNED_BYTE, True),
        )  # fmt: skip
        fields: Any = self.vertices.dtype.fields
        for place, name, width, kind, scaled in columns:
            if name in fields:
                at = ctypes.c_void_p(fields[name][1])
                GL.glVertexAttribPointer(place, width, kind, scaled, stride, at)
                GL.glEnableVertexAttribArray(place)
        if self.influences:
            GL.glVertexAttribIPointer(4, 4, GL.GL_UNSIGNED_BYTE, stride, ctypes.c_void_p(fields["joints"][1]))
            GL.glEnableVertexAttribArray(4)
        GL.glBindBuffer(GL.GL_ELEMENT_ARRAY_BUFFER, self._buffers[1])
        GL.glBufferData(GL.GL_ELEMENT_ARRAY_BUFFER, self.faces.nbytes, self.faces, GL.GL_STATIC_DRAW)
        GL.glBindVertexArray(0)

    def update(self, first_vertex: int, vertices: NDArray[Any] | None, first_face: int, faces: NDArray[Any]) -> None:
        """Write over a part of the vertices (or none) and of the faces."""
        faces = np.ascontiguousarray(faces, np.uint32)
        self.faces[first_face : first_face + len(faces)] = faces
        if vertices is not None:
            self.vertices[first_vertex : first_vertex + len(vertices)] = vertices
        if self._vaid is None:
            return
        if vertices is not None:
            GL.glBindBuffer(GL.GL_ARRAY_BUFFER, self._buffers[0])
            GL.glBufferSubData(
                GL.GL_ARRAY_BUFFER, first_vertex * vertices.dtype.itemsize, vertices.nbytes,
                np.ascontiguousarray(vertices),
            )  # fmt: skip
        GL.glBindVertexArray(self._vaid)
        GL.glBufferSubData(GL.GL_ELEMENT_ARRAY_BUFFER, first_face * 12, faces.nbytes, faces)
        GL.glBindVertexArray(0)

    def draw(self) -> None:
        """Draw with the program in use; uploads at the first time."""
        if self._vaid is None:
            self._add_to_context()
        GL.glBindVertexArray(self._vaid)
        GL.glDrawElements(GL.GL_TRIANGLES, self.faces.size, GL.GL_UNSIGNED_INT, None)
