"""Contact sheets of walking, to be looked at: from the side and from above, of both humans, in out/walk/.

    python scripts/make_walk_sheets.py [CAPTURE.bvh] [--docs]

A straight walk, a start to the left, a step aside, a walk round the table. If a capture is named, also the person who
performed it, from the same distances as the straight walk, the camera going along with both. `--docs` makes
docs/pictures/walk.png out of some of them.
"""

from __future__ import annotations

import argparse
import subprocess
import sys
import tempfile
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from PIL import Image

from ahmss.motion.clip import load

ROOT = Path(__file__).parents[1]
OUT = ROOT / "out" / "walk"
AHMSS = [sys.executable, "-m", "ahmss"]
Place = tuple[float, float, float]


@dataclass(frozen=True)
class Case:
    """A walk: the scene, where the human stands at first, what it does; cameras that look at a place.

    follow: whether the cameras go along with the human.
    """

    scene: str
    at: str
    do: str
    side: Place
    above: Place
    looks_at: Place
    every: int
    follow: bool = False


FLOORS = "floor at -3 0\nadd floor as floor_2 at 3 0"  # 12 by 6 metres: a captured walk is 8 m long


def along(x: float) -> tuple[Place, Place, Place]:
    """Cameras at the side and above, and what they look at, for who begins to walk along x there."""
    return (x, -3.5, 1.1), (x, -0.1, 3.9), (x, 0.0, 0.85)


CASES = {
    "straight": Case(FLOORS, "-3 0", "floor walk to 3 0", *along(-3.0), 9, follow=True),
    "start_90": Case("floor", "0 -0.9", "floor walk to 0 0.9", (3.8, 0.0, 1.2), (-0.1, 0.0, 4.0), (0.0, 0.0, 0.85), 7),
    "aside": Case(
        "floor", "0 0", "floor walk to 0 -0.3 facing 0", (2.7, -0.15, 1.1), (-0.1, -0.15, 3.2), (0.0, -0.15, 0.85), 7
    ),
    "round_the_table": Case(
        "room", "-1.0 1.2", "floor walk to 1.75 -0.1 facing 180", (0.2, 3.7, 2.0), (0.4, 0.45, 6.3),
        (0.4, 0.55, 0.6), 12,
    ),
}  # fmt: skip
PICTURED = CASES | {
    "straight": Case("floor", "-1.5 0", "floor walk to 1.5 0", (0.0, -5.0, 1.1), (0.0, -0.1, 5.0), (0.0, 0.0, 0.85), 9)
}
"""The documentation's: there the straight walk passes a camera that stands, so that one sees it get on."""


def run(*arguments: str) -> None:
    """One `ahmss` command; what it says is shown where it fails."""
    done = subprocess.run([*AHMSS, *arguments], capture_output=True, text=True, check=False)
    if done.returncode:
        sys.exit(f"ahmss {' '.join(arguments)}\n{done.stdout}{done.stderr}")


def sheets(recording: Path, human: str, name: str, case: Case) -> None:
    """Both views of a recording."""
    looked_at = ["--look-at", *map(str, case.looks_at)]
    if case.follow:
        looked_at += ["--follow", human]
    for view, camera in (("side", case.side), ("above", case.above)):
        target = OUT / f"{name}_{view}.png"
        size = "420x300" if view == "side" else "300x300"
        run(
            "view", str(recording), "--headless", "--sheet", str(target), "--every", str(case.every), "--size", size,
            "--position", *map(str, camera), *looked_at,
        )  # fmt: skip
        print(f"wrote {target.relative_to(ROOT)}")


def walk(folder: Path, human: str, name: str, case: Case) -> None:
    """A walk of ours."""
    script, recording = folder / "walk.txt", folder / "walk.rec"
    script.write_text(f"add {case.scene}\nhuman {human} body {human} at {case.at}\ndo {case.do}\n")
    run("play", str(script), "--fast", "--record", str(recording))
    sheets(recording, human, f"{human}_{name}", case)


def capture(folder: Path, file: Path) -> None:
    """A captured walk as the straight walk of ours is seen: along x, from the same distances."""
    home = folder / "lab"
    run("init", str(home))
    clip = home / "objectdb" / "floor" / "captured.npz"
    run("motion", "import", str(file), "--body", "aiko", "-o", str(clip))
    motion = load(clip)
    way = motion.root[-1, :2] - motion.root[0, :2]
    x = -0.5 * float(np.linalg.norm(way))
    with (home / "objectdb" / "floor" / "object.toml").open("a") as record:
        record.write(
            '\n[affordances.captured]\nhuman_algorithm = "playback"\nmotion = "captured.npz"\n'
            f"frames = {round(motion.duration * 60)}\n"
        )
    script, recording = folder / "captured.txt", folder / "captured.rec"
    facing = -float(np.degrees(np.arctan2(way[1], way[0])))
    script.write_text(f"add {FLOORS}\nhuman aiko body aiko at {x:.3f} 0 facing {facing:.2f}\ndo floor captured\n")
    run("play", str(script), "--workspace", str(home), "--fast", "--record", str(recording))
    side, above, looks_at = along(x)
    case = replace(CASES["straight"], side=side, above=above, looks_at=looks_at)
    sheets(recording, "aiko", f"captured_{file.stem}", case)


def picture(folder: Path) -> None:
    """A few pictures of each walk, for the documentation."""
    rows: list[Image.Image] = []
    for human, name, first, every in (
        ("aiko", "straight", 92, 8), ("ken", "start_90", 30, 14), ("aiko", "aside", 30, 14),
        ("ken", "round_the_table", 60, 44),
    ):  # fmt: skip
        case = PICTURED[name]
        script, recording = folder / "walk.txt", folder / "walk.rec"
        script.write_text(f"add {case.scene}\nhuman {human} body {human} at {case.at}\ndo {case.do}\n")
        run("play", str(script), "--fast", "--record", str(recording))
        camera = case.above if name == "round_the_table" else case.side
        tiles: list[Image.Image] = []
        for number in range(7):
            shot = folder / "shot.png"
            at = f"{(first + number * every) / 60:.3f}"
            run(
                "view", str(recording), "--headless", "--snapshot", str(shot), "--at", at, "--size", "230x250",
                 "--position", *map(str, camera), "--look-at", *map(str, case.looks_at),
            )  # fmt: skip
            tiles.append(Image.open(shot).convert("RGB"))
        row = Image.new("RGB", (len(tiles) * 232 - 2, 250), "white")
        for number, tile in enumerate(tiles):
            row.paste(tile, (number * 232, 0))
        rows.append(row)
    page = Image.new("RGB", (rows[0].width, len(rows) * 252 - 2), "white")
    for number, row in enumerate(rows):
        page.paste(row, (0, number * 252))
    page.quantize(128).save(ROOT / "docs" / "pictures" / "walk.png", optimize=True)
    print("wrote docs/pictures/walk.png")


def main() -> None:
    """All sheets, or the picture of the documentation."""
    parser = argparse.ArgumentParser(description="Make contact sheets of walking in out/walk/, to be looked at.")
    parser.add_argument("capture", nargs="?", type=Path, help="a BVH file of a walk, to be seen beside ours")
    parser.add_argument("--docs", action="store_true", help="make docs/pictures/walk.png instead")
    asked = parser.parse_args()
    with tempfile.TemporaryDirectory(prefix="ahmss-walk-") as folder:
        if asked.docs:
            picture(Path(folder))
            return
        OUT.mkdir(parents=True, exist_ok=True)
        for human in ("ken", "aiko"):
            for name, case in CASES.items():
                walk(Path(folder), human, name, case)
        if asked.capture:
            capture(Path(folder), asked.capture)


if __name__ == "__main__":
    main()
