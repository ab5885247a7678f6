"""What the film of the demo shows: its camera stands still, and what the human acts on is to be seen all the time."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from ahmss_viewer.graphics import find_headless, use_headless

if find_headless() is None:
    pytest.skip("nothing here draws without a window", allow_module_level=True)
else:
    use_headless()

from ahmss_viewer.camera import View, project
from ahmss_viewer.choosing import without_hidden
from ahmss_viewer.framing import Interest
from ahmss_viewer.options import ViewOptions
from ahmss_viewer.replaying import _Run
from ahmss_viewer.source import Replay
from ahmss_viewer.studio import Studio

from ahmss.body.links import INDEX

from .conftest import CUP

pytestmark = pytest.mark.timeout(180)  # the first test plays the demo

SIZE = (960, 540)
ASPECT = SIZE[0] / SIZE[1]


def seen(studio: Studio, points: np.ndarray, view: View) -> float:
    """The share of the points (n, 3) that nothing hides and that lie in the picture."""
    wanted = Interest(points, np.full(len(points), 0.1), np.full(len(points), 0.14), np.array([1.0, 0.0, 0.0]))
    free = without_hidden(studio.stage, studio.painter, wanted, view, ASPECT, [wanted])
    place = project(free, view, SIZE)[:, :2] / SIZE
    return float(((place > 0.0) & (place < 1.0)).all(axis=1).sum() / len(points))


def test_head_hand_and_cup_are_seen_all_the_time(recording: Path, tmp_path: Path) -> None:
    source = Replay(recording)
    with Studio() as studio:
        run = _Run(ViewOptions(snapshot=tmp_path / "last.png", size=SIZE), source, studio, None)
        run.run()
        view = run.aim.view
        assert view is not None
        human: list[float] = []
        for tick in range(30, len(source), 30):
            run.mirror.show(source.show(tick))
            (ken,), things = studio.stage.actors.values(), {t.name: t for t in studio.stage.things.values()}
            human.append(seen(studio, ken.places[[INDEX["head"], INDEX["right_hand"]]], view))
            assert seen(studio, things[CUP].centre()[None], view) == 1.0, tick
        assert np.mean(human) > 0.6, "who looks down hides the neck, and the cup the hand"
        assert np.mean(np.array(human) == 0.0) < 0.1
    source.close()
