"""A human, a START, and a launcher that leaves nothing behind."""

from __future__ import annotations

from collections.abc import Callable, Iterator

import pytest
from algorithm_rig import HUMAN, ROOT, ROTATIONS

from ahmss.algorithm.messages import ObjectRecord, PoseRecord, SiteRecord, Start
from ahmss.processes.deadlines import Deadlines
from ahmss.processes.hire import Pool
from ahmss.processes.launcher import Launcher


@pytest.fixture
def make_start() -> Callable[..., Start]:
    def make(kind: str = "human", frames: int = 60, **others: object) -> Start:
        cup = ObjectRecord(
            7, "room/cup", "cup", (0.4, -0.1, 0.8), (1.0, 0.0, 0.0, 0.0),
            {"handle": SiteRecord((0.04, 0.0, 0.05)), "side": SiteRecord((0.0, 0.0, 0.05), free_axis="z")},
            {"mass": 0.2}, {"full": True},
        )  # fmt: skip
        fields = {"object": cup, "site": "handle", "human": HUMAN.to_record(), "pose": PoseRecord.of(ROTATIONS, ROOT)}
        return Start(kind=kind, frames=frames, **(fields | others))

    return make


@pytest.fixture
def launcher() -> Iterator[Launcher]:
    """Without the pool; short deadlines."""
    with Launcher(warm=False, deadlines=Deadlines(start=10.0, frame=0.5, stop=0.2)) as made:
        yield made
        made.close()
        assert made.processes == ()


@pytest.fixture(scope="session")
def pool() -> Iterator[Pool]:
    """The pool kept alive between tests."""
    made = Pool()
    yield made
    made.close()


@pytest.fixture
def warm_launcher(pool: Pool) -> Iterator[Launcher]:
    """With the pool."""
    complaints: list[str] = []
    with Launcher(deadlines=Deadlines(start=20.0, frame=5.0, stop=0.5), notice=complaints.append) as made:
        yield made
        made.close()
        assert made.processes == ()
    assert complaints == []
