"""Where a picture is drawn: a framebuffer of our own, read back as an array, or the window."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray
from OpenGL import GL

__all__ = ["Screen", "Target"]


class Target:
    """A colour and a depth buffer.

    Without a GPU each sample costs: `samples` 4 smooths edges for a third more time, `supersampling` 2 smooths all
    for three times more. The live view takes neither.
    """

    def __init__(self, width: int, height: int, *, supersampling: int = 1, samples: int = 0) -> None:
        self.size = (width, height)
        self.drawn = (width * supersampling, height * supersampling)
        self._buffers: list[Any] = []
        self._framebuffers: list[Any] = []
        self._large = self._small = self._framebuffer(*self.drawn, samples, depth=True)
        self._resolved = self._framebuffer(*self.drawn, 0, depth=False) if samples else self._large
        self._small = self._framebuffer(width, height, 0, depth=False) if supersampling > 1 else self._resolved
        self._pixels = np.empty((height, width, 3), np.uint8)

    def _framebuffer(self, width: int, height: int, samples: int, *, depth: bool) -> Any:
        framebuffer = GL.glGenFramebuffers(1)
        GL.glBindFramebuffer(GL.GL_FRAMEBUFFER, framebuffer)
        parts = [(GL.GL_RGBA8, GL.GL_COLOR_ATTACHMENT0)]
        if depth:
            parts.append((GL.GL_DEPTH_COMPONENT24, GL.GL_DEPTH_ATTACHMENT))
        for kind, attachment in parts:
            buffer = GL.glGenRenderbuffers(1)
            GL.glBindRenderbuffer(GL.GL_RENDERBUFFER, buffer)
            if samples:
                GL.glRenderbufferStorageMultisample(GL.GL_RENDERBUFFER, samples, kind, width, height)
            else:
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
        if self._resolved is not self._large:
            _copy(self._large, self.drawn, self._resolved, self.drawn)
        if self._small is not self._resolved:
            _copy(self._resolved, self.drawn, self._small, self.size)
        GL.glBindFramebuffer(GL.GL_FRAMEBUFFER, self._small)
        GL.glPixelStorei(GL.GL_PACK_ALIGNMENT, 1)
        GL.glReadPixels(0, 0, *self.size, GL.GL_RGB, GL.GL_UNSIGNED_BYTE, self._pixels)
        return self._pixels[::-1]

    def read_depth(self) -> NDArray[np.float32]:
        """The depth buffer (height, width), 0 near to 1 far, top row first; of a target without samples."""
        GL.glBindFramebuffer(GL.GL_FRAMEBUFFER, self._large)
        depth = np.empty((self.drawn[1], self.drawn[0]), np.float32)
        GL.glReadPixels(0, 0, *self.drawn, GL.GL_DEPTH_COMPONENT, GL.GL_FLOAT, depth)
        return depth[::-1]

    def delete(self) -> None:
        """Free the buffers."""
        GL.glDeleteFramebuffers(len(self._framebuffers), self._framebuffers)
        GL.glDeleteRenderbuffers(len(self._buffers), self._buffers)


class Screen:
    """The window's own buffers."""

    def __init__(self, width: int, height: int) -> None:
        self.drawn = (width, height)

    def begin(self) -> None:
        """Draw into it from now on."""
        GL.glBindFramebuffer(GL.GL_FRAMEBUFFER, 0)
        GL.glViewport(0, 0, *self.drawn)


def _copy(source: Any, source_size: tuple[int, int], to: Any, to_size: tuple[int, int]) -> None:
    """Copy colours from one framebuffer to another, averaging where it is smaller."""
    GL.glBindFramebuffer(GL.GL_READ_FRAMEBUFFER, source)
    GL.glBindFramebuffer(GL.GL_DRAW_FRAMEBUFFER, to)
    GL.glBlitFramebuffer(0, 0, *source_size, 0, 0, *to_size, GL.GL_COLOR_BUFFER_BIT, GL.GL_LINEAR)
