"""An object algorithm that is late is shown every frame of the human, and its motion ends when it has answered them."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from ahmss.main.process import MainProcess
from ahmss.world.link import Pending
from ahmss.world.process import ServerProcess
from ahmss.world.schema import Reply
from tests.main.conftest import write_algorithm
from tests.main.ground import steps
from tests.main.test_process import ARM, Film

Start = Callable[..., ServerProcess]
Join = Callable[..., MainProcess]

PARAMETERS = '[parameters.late]\ntype = "float"\ndefault = 0.06\n'
TRACE = '''
import time
import numpy as np
from ahmss.algorithm import ObjectTask, run

def trace(task: ObjectTask):
    """How high the palm was and is, and the largest step that it was seen to make. It is late at every fourth frame."""
    before, leap, first = None, 0.0, None
    for human in task.frames():
        if human.k % 4 == 0:
            time.sleep(task.parameter("late", 0.06))
        place = human.right_grip.place.copy()
        leap = leap if before is None else max(leap, float(np.linalg.norm(place - before)))
        before, first = place, float(place[2]) if first is None else first
        yield task.pose(None, None, {"first": first, "height": float(place[2]), "leap": leap})

run(trace)
'''
KIND = """
[states.first]
range = [0.0, 3.0]

[states.height]
range = [0.0, 3.0]

[states.leap]
range = [0.0, 1.0]

[affordances.lead]
human_algorithm = "swing"
object_algorithm = "trace"
frames = 40

[affordances.lead_for_ever]
human_algorithm = "swing"
object_algorithm = "trace"
parameters = { late = 3600.0 }
frames = 40
"""


class Late:
    """A claim that the server grants when the motion has come to its 25th frame; `palm`: where the hand is then."""

    def __init__(self, pending: Pending, main: MainProcess) -> None:
        self.pending, self.main = pending, main
        self.palm: np.ndarray | None = None

    @property
    def done(self) -> bool:
        if self.palm is None and any(k > 25 for _, k, _ in self.main.control.progress):
            self.palm = self.main.blending.grips[0, :3].copy()
        return self.palm is not None and self.pending.done

    def result(self) -> Reply:
        return self.pending.result()


@pytest.fixture
def ken(server: Start, join: Join, workspace: Path) -> MainProcess:
    """A main at the pace of the clock, with a box whose algorithms are late."""
    write_algorithm(workspace, "trace", "object", PARAMETERS, TRACE)
    with (workspace / "objectdb/box/object.toml").open("a") as file:
        file.write(KIND)
    main = join(server())
    main.play(steps("add box as b at 0.3 0 1"))
    return main


def test_a_late_one_is_shown_every_frame_and_ends_where_the_hand_ended(ken: MainProcess) -> None:
    film = Film(ken, "do b lead", "wait 0.3")
    assert ken.report.messages == []
    palms = np.array(film.grips)[:, 0, :3]
    seen = ken.communication.update(complete=True).objects["b"]
    assert seen.states["height"] == pytest.approx(palms[-1, 2], abs=1e-9)
    assert seen.states["leap"] == pytest.approx(np.linalg.norm(np.diff(palms, axis=0), axis=1).max(), abs=1e-9)
    assert palms[-1, 2] - palms[0, 2] > 0.03
    assert seen.holder == ""


def test_one_whose_claim_is_granted_late_is_shown_what_came_before(
    ken: MainProcess, monkeypatch: pytest.MonkeyPatch
) -> None:
    claim, late = ken.communication.claim, list[Late]()

    def claim_late(name: str, hand: str) -> Late:
        late.append(Late(claim(name, hand), ken))
        return late[-1]

    monkeypatch.setattr(ken.communication, "claim", claim_late)
    film = Film(ken, "do b lead", "wait 0.3")
    assert ken.report.messages == []
    palms = np.array(film.grips)[:, 0, :3]
    states = ken.communication.update(complete=True).objects["b"].states
    assert states["first"] == pytest.approx(palms[0, 2], abs=1e-9)
    assert states["height"] == pytest.approx(palms[-1, 2], abs=1e-9)
    assert late[0].palm is not None
    assert np.linalg.norm(late[0].palm - palms[0]) > 0.02  # it had moved when the claim was granted


def test_one_that_never_answers_is_given_up_and_the_motion_ends(ken: MainProcess) -> None:
    film = Film(ken, "do b lead_for_ever", "wait 0.3")
    assert len(ken.report.messages) == 1
    assert "algorithm trace at frame 4: it gave no pose within 1 s" in ken.report.messages[0]
    assert ken.report.messages[0].endswith("b stays where it is")
    assert film.angles(ARM)[-1] == pytest.approx(0.6, abs=1e-3)
    assert ken.communication.update(complete=True).objects["b"].holder == ""
