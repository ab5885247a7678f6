"""Which OpenGL the pictures come from: EGL or OSMesa without a window, GLX with one.

PyOpenGL binds itself to one of them when it is first imported, so one process draws either into a window or not, and
what this module decides must stand in the environment before that import.
"""

from __future__ import annotations

import ctypes
import os
import sys
from typing import Any

from ahmss.errors import DependencyError

__all__ = ["HEADLESS_CURE", "WINDOW_CURE", "Offscreen", "find_headless", "use_headless", "use_window"]

HEADLESS_CURE = "apt-get install libegl1 libgl1-mesa-dri"
WINDOW_CURE = "apt-get install libgl1 libgl1-mesa-dri libglu1-mesa"
_EGL_PLATFORM_DEVICE = 0x313F


def find_headless() -> str | None:
    """`"egl"`, `"osmesa"`, or None: what can draw here without a window. Asks EGL itself, not only for its file.

    What stands in PYOPENGL_PLATFORM is taken, if it is one of the two.
    """
    wished = os.environ.get("PYOPENGL_PLATFORM", "")
    if wished in ("egl", "osmesa"):
        return wished
    if _egl_answers():
        return "egl"
    return "osmesa" if _library("libOSMesa.so.8", "libOSMesa.so.6", "libOSMesa.so") is not None else None


def use_headless() -> str:
    """Bind this process to drawing without a window; returns `"egl"` or `"osmesa"`.

    Raises:
        DependencyError: neither is installed, or the process already draws into a window.
    """
    chosen = os.environ.get("PYOPENGL_PLATFORM") if "OpenGL" in sys.modules else find_headless()
    if chosen not in ("egl", "osmesa"):
        if "OpenGL" in sys.modules:
            raise DependencyError("this process draws into a window; start another one for pictures without a window")
        raise DependencyError(f"no OpenGL for pictures without a window is installed here; run: {HEADLESS_CURE}")
    os.environ["PYOPENGL_PLATFORM"] = chosen
    return chosen


def use_window() -> None:
    """Bind this process to drawing into a window.

    Raises:
        DependencyError: there is no display, or it does not answer.
    """
    if sys.platform.startswith("linux"):
        if not os.environ.get("DISPLAY"):
            raise DependencyError(
                "there is no display for a window (DISPLAY is not set); use --headless with --record, --snapshot or "
                "--sheet"
            )
        # pyglet's windows are X11's even in a Wayland session, where PyOpenGL alone would take EGL.
        os.environ["PYOPENGL_PLATFORM"] = "glx"
        _reach_display()
    else:
        os.environ.pop("PYOPENGL_PLATFORM", None)


def _reach_display() -> None:
    """Connect to the X display, which pyglet does when it is imported and then says in its own way."""
    from pyglet.display import get_display
    from pyglet.display.xlib import NoSuchDisplayException

    try:
        get_display()
    except NoSuchDisplayException:
        raise DependencyError(
            f"no window can be opened: the display {os.environ['DISPLAY']} does not answer; set DISPLAY to one that "
            "does, or use --headless with --record, --snapshot or --sheet"
        ) from None


class Offscreen:
    """An OpenGL context without a window, current in the thread that made it. Use as a context manager."""

    def __init__(self) -> None:
        self.name = use_headless()
        try:
            self._platform = self._egl() if self.name == "egl" else self._osmesa()
        except Exception as error:
            raise DependencyError(
                f"OpenGL without a window ({self.name}) does not start ({error or type(error).__name__}); "
                f"run: {HEADLESS_CURE}"
            ) from error

    @staticmethod
    def _egl() -> Any:
        """pyrender's EGL platform on the first device that works: a machine may list a card that it may not open."""
        from pyrender.platforms import egl

        devices = [egl.get_device_by_index(int(os.environ["EGL_DEVICE_ID"]))] if "EGL_DEVICE_ID" in os.environ else []
        failed: Exception = RuntimeError("EGL knows no device")
        for device in devices or [*egl.query_devices(), egl.EGLDevice(None)]:
            platform: Any = egl.EGLPlatform(16, 16, device=device)
            try:
                platform.init_context()
                platform.make_current()
            except Exception as error:  # noqa: BLE001 - drivers fail in their own ways; the last one is reported
                failed = error
            else:
                return platform
        raise failed

    @staticmethod
    def _osmesa() -> Any:
        """pyrender's OSMesa platform; its own buffer stays tiny, the pictures go to a framebuffer object."""
        from pyrender.platforms.osmesa import OSMesaPlatform

        platform: Any = OSMesaPlatform(16, 16)
        platform.init_context()
        platform.make_current()
        return platform

    def __enter__(self) -> Offscreen:
        """The context itself."""
        return self

    def __exit__(self, *_: object) -> None:
        """Close."""
        self.close()

    def close(self) -> None:
        """Free the context."""
        if self._platform is not None:
            self._platform.delete_context()
            self._platform = None


def _library(*names: str) -> Any | None:
    """The first of these shared libraries that loads."""
    for name in names:
        try:
            return ctypes.CDLL(name)
        except OSError:
            continue
    return None


def _egl_answers() -> bool:
    """True if libEGL is there and initialises a display of any device."""
    egl = _library("libEGL.so.1", "libEGL.so")
    if egl is None:
        return False
    egl.eglGetProcAddress.restype = ctypes.c_void_p
    egl.eglGetDisplay.restype = ctypes.c_void_p
    egl.eglGetDisplay.argtypes = [ctypes.c_void_p]
    egl.eglInitialize.argtypes = [ctypes.c_void_p] * 3
    displays = [*_device_displays(egl), egl.eglGetDisplay(None)]
    return any(display and egl.eglInitialize(display, None, None) for display in displays)


def _device_displays(egl: Any) -> list[int | None]:
    """The display of each device that EGL lists."""
    query = egl.eglGetProcAddress(b"eglQueryDevicesEXT")
    open_display = egl.eglGetProcAddress(b"eglGetPlatformDisplayEXT")
    if not query or not open_display:
        return []
    count = ctypes.c_int(0)
    devices = (ctypes.c_void_p * 16)()
    ask = ctypes.CFUNCTYPE(ctypes.c_uint, ctypes.c_int, ctypes.c_void_p, ctypes.c_void_p)(query)
    ask(16, devices, ctypes.byref(count))
    show = ctypes.CFUNCTYPE(ctypes.c_void_p, ctypes.c_uint, ctypes.c_void_p, ctypes.c_void_p)(open_display)
    return [show(_EGL_PLATFORM_DEVICE, devices[i], None) for i in range(count.value)]
