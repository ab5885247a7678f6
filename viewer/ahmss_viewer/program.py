"""Shader programs: pyrender's, with what they lack (arrays as uniforms, places of uniforms looked up once)."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from OpenGL import GL
from OpenGL.GL import shaders
from pyrender.shader_program import ShaderProgram

__all__ = ["Program"]

_FOLDER = Path(__file__).parent / "shaders"


class Program(ShaderProgram):
    """One compiled program of `shaders/NAME.vert` and `shaders/NAME.frag` in the current context.

    It is kept by whoever draws with it, not in pyrender's cache: that one asks for the context's identity, which under
    OSMesa is a new object at each call, and so would compile again for every picture.
    """

    def __init__(self, name: str, defines: Mapping[str, int] | None = None) -> None:
        vertex, fragment = (str(_FOLDER / f"{name}.{kind}") for kind in ("vert", "frag"))
        super().__init__(vertex, fragment, defines=dict(defines or {}))
        self._places: dict[str, int] = {}
        self._add_to_context()

    def _add_to_context(self) -> None:
        """Compile; without the validation, which objects to samplers before they have their texture units."""
        array = GL.glGenVertexArrays(1)
        GL.glBindVertexArray(array)
        parts = [
            shaders.compileShader(self._load(self.vertex_shader), GL.GL_VERTEX_SHADER),
            shaders.compileShader(self._load(self.fragment_shader), GL.GL_FRAGMENT_SHADER),
        ]
        self._program_id: Any = shaders.compileProgram(*parts, validate=False)
        GL.glBindVertexArray(0)
        self._vao_id: Any = array

    def use(self) -> None:
        """Draw with this program from now on."""
        GL.glUseProgram(self._program_id)

    def place(self, name: str) -> int:
        """Where a uniform is; -1 for one that this program does not have, which OpenGL then ignores."""
        if name not in self._places:
            self._places[name] = int(GL.glGetUniformLocation(self._program_id, name))
        return self._places[name]

    def matrix(self, name: str, value: NDArray[Any]) -> None:
        """Set a 4x4 matrix."""
        GL.glUniformMatrix4fv(self.place(name), 1, True, np.ascontiguousarray(value, np.float32))

    def vectors(self, name: str, value: NDArray[Any]) -> None:
        """Set a vec3, or an array of vec4 from (n, 4)."""
        value = np.ascontiguousarray(value, np.float32)
        if value.ndim == 1 and value.size == 3:
            GL.glUniform3fv(self.place(name), 1, value)
        else:
            GL.glUniform4fv(self.place(name), value.size // 4, value)

    def number(self, name: str, value: int) -> None:
        """Set an integer, such as a texture's unit."""
        GL.glUniform1i(self.place(name), value)
