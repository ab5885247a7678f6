"""Motions captured from the subject through the whole chain, as a user with a tracker would.

The simulated tracker is a process of its own on a pseudo-terminal (Liberty, binary, every frame counted); the driver
reads it, the take is calibrated and stood on the ground, and a table beside the clip adds what sensors don't see. The
simulator's clock is its reader's, so nothing depends on how fast this machine is, and the bytes are the same each time.
"""

from __future__ import annotations

import subprocess
import sys
import tempfile
import time
from dataclasses import replace
from pathlib import Path

import msgspec

from ahmss.body.skeleton import Skeleton
from ahmss.capture import config
from ahmss.capture.clipping import clip_of
from ahmss.capture.record import record
from ahmss.capture.subject import PERFORMANCES
from ahmss.capture.take import Take
from ahmss.motion.annotation import annotate, load_table
from ahmss.motion.clip import Clip

__all__ = ["CAPTURED", "clips", "take"]

CAPTURED = {
    "door/open.npz": "door_open", "door/close.npz": "door_close", "chair/sit.npz": "sit",
    "chair/stand_up.npz": "stand_up", "carton/lift.npz": "lift", "carton/put_down.npz": "put_down",
}  # fmt: skip
"""Which performance each clip of objectdb/ is captured from."""

AROUND = 3.3  # seconds of a performance besides its motion: upright, then ready, and a moment after
PATIENCE = 60.0  # seconds for the simulator to open its line


def clips(skeleton: Skeleton, objectdb: Path) -> dict[str, Clip]:
    """Clips by their path in objectdb/, where their tables are."""
    return {path: _clip(skeleton, objectdb / path, name) for path, name in CAPTURED.items()}


def _clip(skeleton: Skeleton, file: Path, performance: str) -> Clip:
    table = load_table(file.with_suffix(".annotation.toml"))
    captured = clip_of(take(skeleton.name, performance), skeleton).clip
    header = msgspec.structs.replace(captured.header, origin=f"captured by scripts/make_motions.py: {performance}")
    return annotate(replace(captured, header=header), table, skeleton)


def take(body: str, performance: str) -> Take:
    """What the driver reads from the simulated tracker while the subject performs."""
    with tempfile.TemporaryDirectory() as directory:
        file = Path(directory) / "tracker.toml"
        command = ["capture", "simulate", performance, "--body", body, "--kind", "liberty", "--clock", "poll"]
        simulator = subprocess.Popen(
            [sys.executable, "-m", "ahmss", *command, "--config-out", str(file)],
            stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL,
        )  # fmt: skip
        try:
            _wait_for(file, simulator)
            seconds = AROUND + PERFORMANCES[performance].seconds
            return record(config.load(file), seconds, lambda _: None)[0]
        finally:
            simulator.terminate()
            simulator.wait()


def _wait_for(file: Path, simulator: subprocess.Popen[bytes]) -> None:
    """Wait until the simulator has written how to reach it."""
    end = time.monotonic() + PATIENCE
    while not file.exists():
        if simulator.poll() is not None or time.monotonic() > end:
            raise SystemExit(f"the simulated tracker did not start (exit code {simulator.returncode})")
        time.sleep(0.02)
