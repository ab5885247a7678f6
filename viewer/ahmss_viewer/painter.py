"""Draws a stage: its shadows, everything once, the sky behind, flat pictures in front.

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
from ahmss_viewer.target import Screen, Target

__all__ = ["Painter"]

_SUN = np.array([0.34, 0.36, 0.87])
_SHADOW_SIZE = 2048
_FARTHEST_SHADOW = 9.0  # metres from the middle of the picture; beyond it nothing that stands casts a shadow
_IMAGE_UNIT, _SHADOW_UNIT = 0, 1


class Painter:
    """Draws in the current context. `fine`: shadows without steps, for recordings."""

    def __init__(self, *, fine: bool = False) -> None:
        self._soft = False
        self._programs: dict[tuple[str, int, bool, bool], Program] = {}
        self._told: set[Program] = set()
        self._matrices: dict[str, Array] = {}
        self._vectors: dict[str, Array] = {}
        self._sky = Program("sky")
        self._flat = Program("picture")
        self._still = ShadowMap(_SHADOW_SIZE, smooth=False)
        self._shadows = ShadowMap(_SHADOW_SIZE, smooth=fine)
        self._disturbed: Array | None = None
        self._empty: Any = GL.glGenVertexArrays(1)
        self._still_shown: tuple[int, bytes | None] = (-1, None)
        self._sun = _SUN / np.linalg.norm(_SUN)

    def draw(
        self,
        stage: Stage,
        view: View,
        size: tuple[int, int],
        target: Target | Screen,
        flats: Sequence[Flat] = (),
        *,
        soft: bool = False,
    ) -> None:
        """Draw the stage as `view` sees it.

        Args:
            stage: what is to be seen.
            view: from where.
            size: width and height of the picture, in which the flats are placed.
            target: where it is drawn.
            flats: texts in front.
            soft: shadows with soft borders, at twice the cost of a picture.
        """
        self._soft = soft
        GL.glEnable(GL.GL_DEPTH_TEST)
        GL.glDisable(GL.GL_BLEND)
        GL.glDisable(GL.GL_CULL_FACE)
        self._cast(stage, view)
        target.begin()
        GL.glClear(GL.GL_DEPTH_BUFFER_BIT)
        T_clip_world = view.projection(size[0] / size[1]) @ np.linalg.inv(view.pose())
        self._light(T_clip_world, view)
        for batch, T_world_model in stage.moving(seen=True):
            self._draw_solid(batch, T_world_model)
        identity = np.eye(4)
        for batch in stage.still():
            self._draw_solid(batch, identity)
        GL.glDisable(GL.GL_CULL_FACE)
        self._draw_sky()
        self._draw_flats(flats, size)

    def draw_depth(self, stage: Stage, view: View, target: Target) -> None:
        """Only the depths, to find out what hides what."""
        GL.glEnable(GL.GL_DEPTH_TEST)
        target.begin()
        GL.glClear(GL.GL_DEPTH_BUFFER_BIT)
        T_clip_world = view.projection(target.drawn[0] / target.drawn[1]) @ np.linalg.inv(view.pose())
        self._draw_depths(T_clip_world, stage.moving(), cull=True)
        identity = np.eye(4)
        self._draw_depths(T_clip_world, ((batch, identity) for batch in stage.still()), cull=True)
        GL.glDisable(GL.GL_CULL_FACE)

    def _cast(self, stage: Stage, view: View) -> None:
        """Bring the shadows up to date: those of what stands still only when it changed, then copied below the rest."""
        moving, middle = stage.moving_bounds(), np.floor(view.target)
        bounds = stage.still_bounds()
        if bounds is None:
            bounds = moving
        elif moving is not None:
            bounds = np.array([np.minimum(bounds[0], moving[0]), np.maximum(bounds[1], moving[1])])
        if bounds is not None:
            bounds = np.clip(bounds, middle - _FARTHEST_SHADOW, middle + _FARTHEST_SHADOW)
            bounds = np.array([np.floor(2.0 * bounds[0]) / 2.0, np.ceil(2.0 * bounds[1]) / 2.0])
        shown = (stage.still_version(), None if bounds is None else bounds.tobytes())
        identity = np.eye(4)
        if shown != self._still_shown:
            self._still_shown = shown
            self._still.begin(sun_view(self._sun, bounds))
            self._draw_depths(self._still.T_clip_world, ((batch, identity) for batch in stage.still()))
            self._disturbed = None
        copied = self._shadows.take(self._still, self._disturbed)
        self._disturbed = moving if moving is not None else np.zeros((2, 3))
        self._shadows.begin(self._still.T_clip_world, clear=not copied)
        if not copied:
            self._draw_depths(self._shadows.T_clip_world, ((batch, identity) for batch in stage.still()))
        self._draw_depths(self._shadows.T_clip_world, stage.moving())
        ShadowMap.end()

    def _draw_depths(self, T_clip_world: Array, batches: Iterable[tuple[Batch, Array]], *, cull: bool = False) -> None:
        """Draw these into a depth buffer."""
        for batch, T_world_model in batches:
            program = self._program("depth", batch.influences, textured=False)
            program.use()
            program.matrix("T_clip_world", T_clip_world)
            _place(program, batch, T_world_model)
            if cull:
                (GL.glDisable if batch.two_sided else GL.glEnable)(GL.GL_CULL_FACE)
            batch.draw()

    def _light(self, T_clip_world: Array, view: View) -> None:
        """Note this picture's camera, lights and shadows, for each program when it is first used."""
        fill = view.pose()[:3, 2] * np.array([1.0, 1.0, 0.0]) + np.array([0.0, 0.0, 0.5])
        self._shadows.bind(_SHADOW_UNIT)
        self._matrices = {"T_clip_world": T_clip_world, "T_shadows_world": self._shadows.to_texture()}
        self._vectors = {"sun": self._sun, "fill": fill / np.linalg.norm(fill)}
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
            for name, unit in (("shadows", _SHADOW_UNIT), ("image", _IMAGE_UNIT)):
                program.number(name, unit)
        _place(program, batch, T_world_model)
        if batch.texture is not None:
            _bind_image(batch.texture)
        (GL.glDisable if batch.two_sided else GL.glEnable)(GL.GL_CULL_FACE)
        batch.draw()

    def _program(self, name: str, influences: int, *, textured: bool) -> Program:
        """The program for such a batch, compiled when it is first needed."""
        key = (name, influences, textured, self._soft)
        if key not in self._programs:
            defines = ({"SOFT": 1} if self._soft else {}) | ({"TEXTURED": 1} if textured else {})
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
        self._shadows.delete()
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
