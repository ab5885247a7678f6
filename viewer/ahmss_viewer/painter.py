"""Draws a stage: two shadow maps, everything once, the sky behind, flat pictures in front.

pyrender's own renderer spends itself on pixels without a GPU (physically based shading, four samples a pixel: some 15
pictures a second at 640x480). This one lights vertices, keeps the shadows of what stands still, and takes one sample.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np
from OpenGL import GL

from ahmss.body.array import Array
from ahmss_viewer.batch import Batch
from ahmss_viewer.camera import View
from ahmss_viewer.caption import Flat
from ahmss_viewer.program import Program
from ahmss_viewer.shadow import ShadowMap, sun_view
from ahmss_viewer.stage import Stage

__all__ = ["Painter"]

_SUN = np.array([-0.36, 0.30, 0.88])
_FARTHEST_SHADOW = 9.0  # metres from the middle of the picture; beyond it nothing that stands casts a shadow
_STILL_UNIT, _LIVE_UNIT, _IMAGE_UNIT = 1, 2, 0


class Painter:
    """Draws in the current context. `fine`: softer shadows from larger maps, for recordings."""

    def __init__(self, *, fine: bool = False) -> None:
        self._extra = ("FINE",) if fine else ()
        self._programs: dict[tuple[str, int, bool], Program] = {}
        self._told: set[Program] = set()
        self._matrices: dict[str, Array] = {}
        self._vectors: dict[str, Array] = {}
        self._sky = Program("sky")
        self._flat = Program("picture")
        self._still = ShadowMap(2048 if fine else 1024)
        self._live = ShadowMap(1024 if fine else 512)
        self._empty: Any = GL.glGenVertexArrays(1)
        self._still_shown: tuple[int, ...] = ()
        self._sun = _SUN / np.linalg.norm(_SUN)

    def draw(self, stage: Stage, view: View, size: tuple[int, int], target: Any, flats: Sequence[Flat] = ()) -> None:
        """Draw the stage as `view` sees it; `target.begin()` says where, size (width, height) is its pixels'."""
        GL.glEnable(GL.GL_DEPTH_TEST)
        GL.glDisable(GL.GL_BLEND)
        GL.glDisable(GL.GL_CULL_FACE)
        self._cast(stage, view)
        target.begin()
        GL.glClear(GL.GL_DEPTH_BUFFER_BIT)
        T_clip_world = view.projection(size[0] / size[1]) @ np.linalg.inv(view.pose())
        self._light(T_clip_world, view)
        for batch, T_world_model in stage.moving():
            self._draw_solid(batch, T_world_model)
        identity = np.eye(4)
        for batch in stage.still():
            self._draw_solid(batch, identity)
        GL.glDisable(GL.GL_CULL_FACE)
        self._draw_sky()
        self._draw_flats(flats, size)

    def _cast(self, stage: Stage, view: View) -> None:
        """Bring the shadow maps up to date: the still one only when something changed."""
        middle = np.floor(view.target)
        shown = (stage.still_version(), *(int(m) for m in middle))
        if shown != self._still_shown:
            self._still_shown = shown
            bounds = stage.still_bounds()
            if bounds is not None:
                bounds = np.clip(bounds, middle - _FARTHEST_SHADOW, middle + _FARTHEST_SHADOW)
            identity = np.eye(4)
            self._cast_into(self._still, bounds, ((batch, identity) for batch in stage.still()))
        self._cast_into(self._live, stage.moving_bounds(), stage.moving())

    def _cast_into(self, shadow: ShadowMap, bounds: Array | None, batches: Iterable[tuple[Batch, Array]]) -> None:
        shadow.begin(sun_view(self._sun, bounds))
        for batch, T_world_model in batches:
            program = self._program("depth", batch.influences, textured=False)
            program.use()
            program.matrix("T_clip_world", shadow.T_clip_world)
            _place(program, batch, T_world_model)
            batch.draw()
        shadow.end()

    def _light(self, T_clip_world: Array, view: View) -> None:
        """Note this picture's camera, lights and shadows, for each program when it is first used."""
        fill = view.pose()[:3, 2] * np.array([1.0, 1.0, 0.0]) + np.array([0.0, 0.0, 0.5])
        T_live_still = self._live.to_texture() @ np.linalg.inv(self._still.to_texture())
        self._still.bind(_STILL_UNIT)
        self._live.bind(_LIVE_UNIT)
        self._matrices = {"T_clip_world": T_clip_world, "T_still_world": self._still.to_texture()}
        self._vectors = {
            "sun": self._sun,
            "fill": fill / np.linalg.norm(fill),
            "live_scale": np.diagonal(T_live_still)[:3],
            "live_shift": T_live_still[:3, 3],
        }
        self._told.clear()

    def _draw_solid(self, batch: Batch, T_world_model: Array) -> None:
        program = self._program("solid", batch.influences, textured=batch.texture is not None)
        program.use()
        if program not in self._told:
            self._told.add(program)
            for name, matrix in self._matrices.items():
                program.matrix(name, matrix)
            for name, vector in self._vectors.items():
                program.vectors(name, vector)
            for name, unit in (("still_map", _STILL_UNIT), ("live_map", _LIVE_UNIT), ("image", _IMAGE_UNIT)):
                program.number(name, unit)
        _place(program, batch, T_world_model)
        if batch.texture is not None:
            _bind_image(batch.texture)
        (GL.glDisable if batch.two_sided else GL.glEnable)(GL.GL_CULL_FACE)
        batch.draw()

    def _program(self, name: str, influences: int, *, textured: bool) -> Program:
        """The program for such a batch, compiled when it is first needed."""
        key = (name, influences, textured)
        if key not in self._programs:
            defines = dict.fromkeys(self._extra, 1) | ({"TEXTURED": 1} if textured else {})
            defines |= {"SKINNED": 1, "INFLUENCES": influences} if influences else {}
            self._programs[key] = Program(name, defines)
        return self._programs[key]

    def _draw_sky(self) -> None:
        """Behind everything: only pixels that nothing covers."""
        GL.glDepthFunc(GL.GL_LEQUAL)
        GL.glBindVertexArray(self._empty)
        self._sky.use()
        GL.glDrawArrays(GL.GL_TRIANGLES, 0, 3)
        GL.glDepthFunc(GL.GL_LESS)

    def _draw_flats(self, flats: Sequence[Flat], size: tuple[int, int]) -> None:
        """Texts and the like, in pixels from the top left."""
        if not flats:
            return
        GL.glDisable(GL.GL_DEPTH_TEST)
        GL.glEnable(GL.GL_BLEND)
        GL.glBlendFunc(GL.GL_ONE, GL.GL_ONE_MINUS_SRC_ALPHA)
        GL.glBindVertexArray(self._empty)
        self._flat.use()
        self._flat.number("image", _IMAGE_UNIT)
        for flat in flats:
            _bind_image(flat.texture)
            left, top = 2.0 * flat.left / size[0] - 1.0, 1.0 - 2.0 * flat.top / size[1]
            right, bottom = left + 2.0 * flat.width / size[0], top - 2.0 * flat.height / size[1]
            self._flat.vectors("box", np.array([[left, bottom, right, top]]))
            GL.glDrawArrays(GL.GL_TRIANGLE_STRIP, 0, 4)
        GL.glDisable(GL.GL_BLEND)

    def delete(self) -> None:
        """Free what it holds."""
        self._still.delete()
        self._live.delete()
        for program in (*self._programs.values(), self._sky, self._flat):
            program.delete()


def _place(program: Program, batch: Batch, T_world_model: Array) -> None:
    """Where the batch is: a matrix, or the links of a skin."""
    if batch.influences:
        program.vectors("links", batch.links.reshape(-1, 4))
    else:
        program.matrix("T_world_model", T_world_model)


def _bind_image(texture: Any) -> None:
    """Bind a pyrender texture to the image unit, uploading it at the first time."""
    GL.glActiveTexture(int(GL.GL_TEXTURE0) + _IMAGE_UNIT)
    if not texture._in_context():
        GL.glPixelStorei(GL.GL_UNPACK_ALIGNMENT, 1)
        texture._add_to_context()
    texture._bind()
