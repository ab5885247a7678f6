"""Frames computed a second (table 5.6 of the thesis): this process is the main, all others are real ones.

The motions are those of the shipped programs on the shipped clips; the objects that offer them are files in a
workspace of the bench's own, as a user would drop them into objectdb/. Everything is published to a real server, in
lockstep, as fast as it goes.
"""

from __future__ import annotations

import json
import statistics
import tempfile
import time
from collections.abc import Generator
from contextlib import contextmanager
from pathlib import Path

from ahmss.algorithm.messages import Start
from ahmss.algorithm.place import Transform
from ahmss.bench.meeting import meeting_site
from ahmss.body.array import Array
from ahmss.body.skeleton import Skeleton
from ahmss.database.layout import init
from ahmss.database.records import AlgorithmEntry
from ahmss.database.workspace import Workspace
from ahmss.errors import AhmssError
from ahmss.main.command import Do, parse
from ahmss.main.process import MainProcess, Setup
from ahmss.main.script import Step
from ahmss.world.process import ServerProcess
from ahmss.world.schema import NewObject

__all__ = ["CASES", "Rig", "clip_of", "compute_fps", "own_workspace", "rig"]

CASES = {
    "playback": "do thing playback frames {n}",
    "slerp": "do thing slerp frames {n}",
    "fusion": "do thing playback frames {n} with other slerp frames {n}",
    "object": "do thing carry frames {n}",
    "fusion_object": "do thing carry frames {n} with other slerp frames {n}",
    "walk": "do thing walk to {far} 0",
    "walk_fusion": "do thing walk to 0 0 with other slerp frames {n}",
    "walk_object": "do thing stroll to {far} 0",
    "walk_fusion_object": "do thing stroll to 0 0 with other slerp frames {n}",
}
"""What is carried out for each number. A walk of those that begin far away begins where the one before it has ended."""
_AFFORDED = {"playback": "playback", "slerp": "slerp", "carry": "playback", "walk": "walk", "stroll": "walk"}
_MOVING = ("carry", "stroll")
_CAUGHT = 1.0  # metres from it at which a walker's hand holds the thing already: it hangs in it from the first frame on
_NEVER = 0.0  # the same of a thing that is only watched: in the hand it would be elsewhere for the next motion
_HUMAN = "bench"
_WARM, _FRAMES, _ROUNDS = 300, 1000, 5
_PACE = 0.0195  # metres a frame that nobody walks faster than, so that a walk is long enough to be measured


def compute_fps(workspace: Workspace) -> dict[str, float]:
    """Frames a second of each case, the median of several stretches of one long motion."""
    with rig(workspace) as one:
        return {case: one.rate(line) for case, line in CASES.items()}


class Rig:
    """A main with a server of its own, in lockstep."""

    def __init__(self, main: MainProcess) -> None:
        self._main = main
        self._line = 0

    def carry_out(self, line: str) -> None:
        """Carry out a line to its end."""
        self._begin(line)
        while not self._main.agenda.done:
            self._main.frame()

    def rate(self, line: str, frames: int = _FRAMES, rounds: int = _ROUNDS, warm: int = _WARM) -> float:
        """Frames a second while a line is carried out.

        `{n}` in it is the number of frames it needs, `{far}` how many metres take a walker as many.
        """
        needed = warm + rounds * frames + 1
        self._begin(line.format(n=needed, far=round(_PACE * needed, 2)))
        for _ in range(warm):
            self._main.frame()
        took: list[float] = []
        for _ in range(rounds):
            began = time.perf_counter()
            for _ in range(frames):
                self._main.frame()
            took.append(time.perf_counter() - began)
        failures = self._main.report.messages
        if failures:
            raise AhmssError(f"`{line}` can't be measured: {failures[0]}")
        if self._main.agenda.done:
            raise AhmssError(f"`{line}` can't be measured: it was over before {needed} frames")
        while not self._main.agenda.done:
            self._main.frame()
        return frames / statistics.median(took)

    def start_of(self, line: str) -> tuple[AlgorithmEntry, Start]:
        """The algorithm that a line starts for the human, and its START message, as the main would send it now."""
        return self.starts_of(line)[0]

    def starts_of(self, line: str) -> list[tuple[AlgorithmEntry, Start]]:
        """All algorithms that a line starts, the humans' first, each with its START message."""
        parsed = parse(line)
        assert isinstance(parsed, Do)
        main, database = self._main, self._main.database
        orders = [database.order(act, main.communication, main.actor) for act in parsed.acts]
        carried = any(order.human_algorithm.carries for order in orders)
        found: list[tuple[AlgorithmEntry, Start]] = []
        for kind in ("human", "object"):
            for order in orders:
                entry = order.human_algorithm if kind == "human" else order.object_algorithm
                if entry is not None:
                    with_body = kind == "human" and carried and not entry.carries
                    seen, rate = main.communication, main.setup.rate
                    start = database.start(order, kind, seen, main.actor, 0, rate, carried=with_body)
                    found.append((entry, start))
        return found

    @property
    def main(self) -> MainProcess:
        """The main itself."""
        return self._main

    def place_of(self, name: str) -> Array:
        """Where an object is, metres."""
        return self._main.communication.pose(name)[:3].copy()

    def _begin(self, line: str) -> None:
        self._line += 1
        parsed = parse(line)
        assert parsed is not None
        self._main.agenda.add(Step(parsed, self._line, "bench"))


@contextmanager
def rig(workspace: Workspace, objects: int = 0) -> Generator[Rig]:
    """A main that stands in a world with the bench's two things and `objects` others."""
    with tempfile.TemporaryDirectory(prefix="ahmss-bench-") as folder:
        own = own_workspace(workspace, Path(folder) / "workspace")
        with ServerProcess(lockstep=(_HUMAN,), log=Path(folder) / "server.log") as server:
            said: list[str] = []
            setup = Setup(_HUMAN, server=server.address, workspace=own.root, fast=True, names=(_HUMAN,))
            main = MainProcess(setup, said.append)
            try:
                one = Rig(main)
                for line in ("add thing", "add other"):
                    one.carry_out(line)
                _crowd(main, objects)
                yield one
            finally:
                main.close()


def _crowd(main: MainProcess, objects: int) -> None:
    """Fill the world with objects far away, a thousand in a request."""
    client = main.communication.client
    for first in range(0, objects, 1000):
        numbers = range(first, min(first + 1000, objects))
        client.add([NewObject(f"spare_{i}", "other", (50.0, float(i), 0.0), (1.0, 0.0, 0.0, 0.0)) for i in numbers])
    for _ in range(3):  # in lockstep a tick brings them
        main.frame()


def own_workspace(workspace: Workspace, folder: Path) -> Workspace:
    """A copy of a workspace with two kinds more, each of which affords the shipped algorithms."""
    clips = {algorithm: clip_of(workspace, algorithm) for algorithm in ("playback", "slerp", "walk")}
    own = init(folder, workspace)
    site = meeting_site(clips["playback"], Skeleton.of())
    for kind in ("thing", "other"):
        home = folder / "objectdb" / kind
        home.mkdir()
        for algorithm, clip in clips.items():
            (home / f"{algorithm}.npz").write_bytes(clip.read_bytes())
        (home / "object.toml").write_text(_object_file(kind, site))
    return own


def _object_file(kind: str, site: Transform) -> str:
    """A kind with a site and five affordances, two of which move it with the hand."""
    lines = [f"name = {json.dumps(kind)}", "[properties]", "diameter = 0.07", "[sites.here]"]
    lines += [f"position = {site.place.tolist()}", f"orientation = {site.rotation.tolist()}"]
    for name, algorithm in _AFFORDED.items():
        lines += [f"[affordances.{name}]", f'human_algorithm = "{algorithm}"', f'motion = "{algorithm}.npz"']
        lines += ['asks = ["goal_position"]', "frames = 0"] if algorithm == "walk" else ['site = "here"']
        if name in _MOVING:
            lines += ['object_algorithm = "follow_hand"']
            lines += [f"parameters = {{threshold = {_CAUGHT if name == 'stroll' else _NEVER}}}"]
    return "\n".join(lines) + "\n"


def clip_of(workspace: Workspace, algorithm: str) -> Path:
    """A shipped clip that an affordance plays by an algorithm: the largest, whose targets are the most work."""
    found = [
        affordance.motion
        for name in workspace.objects.names()
        for affordance in workspace.objects.get(name).affordances.values()
        if affordance.human_algorithm == algorithm and affordance.motion is not None
    ]
    if not found:
        raise AhmssError(f"{workspace.root}/objectdb: nothing affords a motion by {algorithm} to measure with")
    return max(found, key=lambda path: (path.stat().st_size, path))
