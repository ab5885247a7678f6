#!/bin/sh
# Install the system libraries for pictures without a display, where this user may; else say the one command to type.
# Exit code 0: they are there.

PACKAGES="libegl1 libgl1 libgl1-mesa-dri libosmesa6"

have() { ldconfig -p 2>/dev/null | grep -q "$1"; }

if have libEGL.so.1 && have libGL.so.1; then
    exit 0
fi
if ! command -v apt-get >/dev/null; then
    echo "pictures need the libraries EGL and Mesa; install them by your system's package manager" >&2
    exit 1
fi
if [ "$(id -u)" = 0 ]; then
    SUDO=""
elif command -v sudo >/dev/null && sudo -n true 2>/dev/null; then
    SUDO="sudo"
else
    echo "pictures need system libraries; type: sudo apt-get install -y $PACKAGES" >&2
    exit 1
fi
if DEBIAN_FRONTEND=noninteractive $SUDO apt-get install -y -qq $PACKAGES >/dev/null 2>&1; then
    exit 0
fi
# A fresh machine has no package lists yet.
$SUDO apt-get update -qq >/dev/null 2>&1
DEBIAN_FRONTEND=noninteractive $SUDO apt-get install -y -qq $PACKAGES >/dev/null 2>&1 && exit 0
echo "installing failed; type: sudo apt-get update && sudo apt-get install -y $PACKAGES" >&2
exit 1
