"""Make the motion clips in objectdb/ and humandb/, the same bytes every time.

    .venv/bin/python scripts/make_motions.py [--check]

The motions at the table are posed (motions/table.py); those at the door and the chair are captured from the subject by
a simulated tracker, a driver, the calibration and tables beside the clips (motions/captured.py).
`--check` writes nothing and exits with 1 where a file differs from what it would write.
"""

from __future__ import annotations

import argparse
import sys
import tempfile
from pathlib import Path

from motions import captured, standing, table
from motions.scene import Scene

from ahmss.database import Workspace
from ahmss.motion.clip import Clip, save

ROOT = Path(__file__).resolve().parent.parent
MODEL = "ken"  # on whose body the clips are made; other bodies share the rotations


def make(workspace: Workspace) -> dict[str, Clip]:
    """All clips by their path in the workspace."""
    scene = Scene.of(workspace)
    skeleton = workspace.humans.get(MODEL).skeleton
    clips = {f"objectdb/{path}": clip for path, clip in table.clips(skeleton, scene).items()}
    clips |= {f"objectdb/{path}": clip for path, clip in captured.clips(skeleton, ROOT / "objectdb").items()}
    clips["objectdb/floor/stand.npz"] = standing.clip(skeleton)
    for name in workspace.humans.names():
        clips[f"humandb/{name}/stand.npz"] = standing.clip(workspace.humans.get(name).skeleton)
    return clips


def main() -> int:
    """Write the clips, or check those that there are."""
    parser = argparse.ArgumentParser(
        description="Make the motion clips in objectdb/ and humandb/ and write them, the same bytes every time."
    )
    parser.add_argument("--check", action="store_true", help="write nothing; exit with 1 where a file differs")
    check: bool = parser.parse_args().check
    differing: list[str] = []
    for path, clip in make(Workspace(ROOT)).items():
        file = ROOT / path
        if not check:
            save(clip, file)
            print(f"{path}: {clip.frames} frames, {file.stat().st_size} bytes")
        elif not _same(clip, file):
            differing.append(path)
    for path in differing:
        print(f"{path}: differs from what scripts/make_motions.py makes; run it", file=sys.stderr)
    return 1 if differing else 0


def _same(clip: Clip, file: Path) -> bool:
    with tempfile.TemporaryDirectory() as directory:
        made = Path(directory) / file.name
        save(clip, made)
        return file.is_file() and made.read_bytes() == file.read_bytes()


if __name__ == "__main__":
    sys.exit(main())
