"""Where a picture is drawn: a framebuffer of our own without multisampling, read back as an array."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray
from OpenGL import GL

__all__ = ["Target"]


class Target:
    """A colour and a depth buffer; `supersampling` 2 draws at twice the size and averages (smooth edges)."""

    def __init__(self, width: int, height: int, supersampling: int = 1) -> None:
        self.width, self.height = width, height
        self.drawn = (width * supersampling, height * supersampling)
        self._buffers: list[Any] = []
        self._framebuffers: list[Any] = []
        self._large = self._framebuffer(*self.drawn, depth=True)
        self._small = self._large if supersampling == 1 else self._framebuffer(width, height, depth=False)
        self._pixels = np.empty((height, width, 3), np.uint8)

    def _framebuffer(self, width: int, height: int, *, depth: bool) -> Any:
        framebuffer = GL.glGenFramebuffers(1)
        GL.glBindFramebuffer(GL.GL_FRAMEBUFFER, framebuffer)
        parts = [(GL.GL_RGBA8, GL.GL_COLOR_ATTACHMENT0)]
        if depth:
            parts.append((GL.GL_DEPTH_COMPONENT24, GL.GL_DEPTH_ATTACHMENT))
        for kind, attachment in parts:
            buffer = GL.glGenRenderbuffers(1)
            GL.glBindRenderbuffer(GL.GL_RENDERBUFFER, buffer)
            GL.glRenderbufferStorage(GL.GL_RENDERBUFFER, kind, width, height)
            GL.glFramebufferRenderbuffer(GL.GL_FRAMEBUFFER, attachment, GL.GL_RENDERBUFFER, buffer)
            self._buffers.append(buffer)
        self._framebuffers.append(framebuffer)
        return framebuffer

    def begin(self) -> None:
        """Draw into it from now on."""
        GL.glBindFramebuffer(GL.GL_FRAMEBUFFER, self._large)
        GL.glViewport(0, 0, *self.drawn)

    def read(self) -> NDArray[np.uint8]:
        """The finished picture (height, width, 3), top row first; the array is used again by the next read."""
        if self._small is not self._large:
            GL.glBindFramebuffer(GL.GL_READ_FRAMEBUFFER, self._large)
            GL.glBindFramebuffer(GL.GL_DRAW_FRAMEBUFFER, self._small)
            GL.glBlitFramebuffer(
                0, 0, *self.drawn, 0, 0, self.width, self.height, GL.GL_COLOR_BUFFER_BIT, GL.GL_LINEAR
            )
        GL.glBindFramebuffer(GL.GL_FRAMEBUFFER, self._small)
        GL.glPixelStorei(GL.GL_PACK_ALIGNMENT, 1)
        GL.glReadPixels(0, 0, self.width, self.height, GL.GL_RGB, GL.GL_UNSIGNED_BYTE, self._pixels)
        return self._pixels[::-1]

    def delete(self) -> None:
        """Free the buffers."""
        GL.glDeleteFramebuffers(len(self._framebuffers), self._framebuffers)
        GL.glDeleteRenderbuffers(len(self._buffers), self._buffers)
