"""`ahmss doctor`: what this machine lacks, and the command that mends it."""

from __future__ import annotations

import ctypes.util
import importlib.util
import json
import os
import shutil
import sys
from collections.abc import Callable
from dataclasses import asdict, dataclass

from ahmss.main.demo import has_display

__all__ = ["Finding", "examine", "findings"]

_GL = "sudo apt-get install -y libegl1 libgl1 libgl1-mesa-dri libosmesa6"
_MODULES = ("numpy", "scipy", "trimesh", "pyrender", "OpenGL", "pyglet", "zmq", "msgspec", "ezdxf", "imageio_ffmpeg")


@dataclass(frozen=True)
class Finding:
    """One thing looked at; `cure` is the command that mends it, `needed` whether AHMSS is of little use without."""

    what: str
    ok: bool
    found: str
    cure: str = ""
    needed: bool = True


def examine(*, as_json: bool) -> int:
    """Tell all findings; returns how many needed things are missing."""
    found = findings()
    missing = sum(1 for finding in found if finding.needed and not finding.ok)
    if as_json:
        print(json.dumps({"ok": missing == 0, "findings": [asdict(finding) for finding in found]}))
        return missing
    for finding in found:
        mark = "ok     " if finding.ok else "MISSING" if finding.needed else "absent "
        print(f"{mark} {finding.what}: {finding.found}")
        if finding.cure and not finding.ok:
            print(f"        to mend it: {finding.cure}")
    return missing


def findings() -> list[Finding]:
    """Look at everything."""
    looks: tuple[Callable[[], Finding], ...] = (
        _python,
        _packages,
        _headless,
        _film,
        _window,
        _serial,
        _compiler,
        _keys,
    )
    return [look() for look in looks]


def _python() -> Finding:
    version = ".".join(str(part) for part in sys.version_info[:3])
    return Finding(
        "Python", sys.version_info >= (3, 11), f"{version}, {os.cpu_count()} cores", "install Python 3.11 or newer"
    )


def _packages() -> Finding:
    missing: list[str] = []
    for name in _MODULES:
        if importlib.util.find_spec(name) is None:
            missing.append(name)
    text = f"{', '.join(missing)} can't be imported" if missing else "all are there"
    return Finding("packages", not missing, text, f"{sys.executable} -m pip install ahmss")


def _headless() -> Finding:
    """Pictures without a display need EGL (with a driver) or OSMesa."""
    from ahmss_viewer.graphics import find_headless

    found = find_headless()
    names = {"egl": "by EGL", "osmesa": "by OSMesa", None: "neither EGL nor OSMesa works here"}
    return Finding("pictures without a display", found is not None, names[found], _GL)


def _film() -> Finding:
    try:
        import imageio_ffmpeg

        return Finding("films", True, imageio_ffmpeg.get_ffmpeg_exe())
    except (ImportError, RuntimeError) as error:
        return Finding("films", False, str(error), f"{sys.executable} -m pip install imageio-ffmpeg")


def _window() -> Finding:
    if not has_display():
        cure = "log in at a screen, use ssh -X, or try: xvfb-run -a ahmss view"
        return Finding(
            "a window", False, "there is no display (neither DISPLAY nor WAYLAND_DISPLAY is set)", cure, False
        )
    if ctypes.util.find_library("GL") is None and sys.platform != "darwin":
        return Finding("a window", False, "the library GL is missing", _GL, False)
    return Finding("a window", True, f"on display {os.environ.get('DISPLAY') or os.environ.get('WAYLAND_DISPLAY', '')}")


def _serial() -> Finding:
    from serial.tools import list_ports

    ports = sorted(port.device for port in list_ports.comports())
    if not ports:
        cure = "plug the tracker in; in a container pass the device on, such as --device /dev/ttyUSB0"
        return Finding("a serial port", False, "none (only trackers need one)", cure, False)
    closed = [port for port in ports if not os.access(port, os.R_OK | os.W_OK)]
    if closed:
        cure = f"sudo usermod -aG dialout {os.environ.get('USER', '$USER')}   (and log in again)"
        return Finding("a serial port", False, f"{', '.join(closed)} may not be opened by this user", cure, False)
    return Finding("a serial port", True, ", ".join(ports))


def _compiler() -> Finding:
    found = next((path for name in ("cc", "gcc", "clang") if (path := shutil.which(name))), "")
    text = found or "none (only algorithms in C need one)"
    return Finding("a C compiler", bool(found), text, "sudo apt-get install -y gcc", False)


def _keys() -> Finding:
    import zmq

    curve = bool(zmq.has("curve"))
    text = "ZeroMQ has CURVE" if curve else "this ZeroMQ was built without CURVE"
    return Finding("servers for other machines", curve, text, f"{sys.executable} -m pip install --upgrade pyzmq", False)
