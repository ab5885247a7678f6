"""A telephone used from where it is not just before one: nothing of it is in head or hand, nor held from afar."""

from __future__ import annotations

import msgspec
import numpy as np
import pytest

from ahmss.algorithm import Transform
from ahmss.body.inverse import grips
from ahmss.errors import AlgorithmError

from .devices import begun
from .scene import WORKSPACE
from .test_taking_up import Scene, in_the_head, in_the_telephone

MOTION = str(WORKSPACE.objects.get("handset").affordances["pick_up"].motion)


def scene(name: str, away: float, aside: float, turn: float = 0.0, motion: str | None = MOTION) -> Scene:
    """Somebody takes the handset from there, with the right hand."""
    return Scene(
        name, "right", "handset", "bar", "ear", away, motion, over=-0.025, aside=aside, turn=turn, along=0.3
    )  # fmt: skip


def from_start(made: Scene) -> float:
    """Metres that one has gone."""
    roots = np.array([pose.root for pose in made.shown])
    return float(np.linalg.norm((roots[-1] - roots[0])[:2]))


def test_who_comes_short_of_the_handset_steps_nearer_and_closes_on_it() -> None:
    """The hand stopped 39 mm short of it, fingers 12 mm in it, and it was held all the same."""
    made = scene("aiko", away=0.77, aside=-0.45)
    assert from_start(made) > 0.2
    caught = next(k for k, pose in enumerate(made.followed) if pose.states.get("taken") == "yes")
    assert in_the_telephone(made, made.shown[: caught + 1], made.followed[: caught + 1]) < 0.002
    palm = Transform.of(grips(made.body.skeleton, made.shown[caught].rotations, made.shown[caught].root)[0])
    target = made.shown[caught].targets[0]
    assert np.linalg.norm(palm.place - target[:3]) < 0.002


def test_who_comes_short_of_it_and_may_not_step_is_told_by_how_much() -> None:
    with pytest.raises(AlgorithmError, match=r"the right hand stops \d+ mm short of it"):
        scene("aiko", away=0.77, aside=-0.45, motion=None)


def test_who_bends_to_it_over_the_side_of_a_table_holds_it_to_the_ear_upright() -> None:
    """The trunk leant for a place that the ear had left: the handset was 17 mm in the face, by a way through it."""
    made = scene("aiko", away=0.0, aside=-0.6, turn=-90.0)
    assert in_the_head(made, made.shown, made.followed) < 0.002


@pytest.mark.parametrize(("name", "aside"), [("aiko", 0.3), pytest.param("ken", -0.45, marks=pytest.mark.long)])
def test_what_is_at_the_ear_stays_out_of_the_head_as_one_steps_to_where_it_is_laid_down(
    name: str, aside: float
) -> None:
    """The head turned to the telephone on the way: it came 20 mm into the handset, which then left through the face."""
    made = scene(name, away=0.77, aside=aside)
    held = made.held
    shown = made.goes_on("lay_down", {"rest": "cradle"}, "release", world=made.world, motion=MOTION, busy=["right"])
    laid = made.both(shown)
    assert np.linalg.norm(shown[-1].root[:2] - shown[0].root[:2]) > 0.2
    assert np.linalg.norm(held.place - laid[0].place) < 0.01
    assert in_the_head(made, shown, laid) < 0.002
    assert np.linalg.norm(laid[-1].place - made.frame.place) < 0.003


@pytest.mark.parametrize(("name", "away", "aside"), [("aiko", 0.45, -0.3), ("aiko", 0.45, 0.0)])
def test_the_hand_that_has_laid_it_down_is_let_down_beside_it(name: str, away: float, aside: float) -> None:
    """It went straight down through handset and table, moved aside too late: fingers were 12 mm in the handset."""
    made = scene(name, away, aside)
    shown = made.goes_on("lay_down", {"rest": "cradle"}, "release", world=made.world, motion=MOTION, busy=["right"])
    lies = made.both(shown)[-1]
    about = [*made.world, msgspec.structs.replace(made.named(Transform(lies.place, lies.rotation)), id=7)]
    stand = WORKSPACE.objects.get("floor").affordances["stand"]
    start = begun(made.body, None, "", {}, motion=str(stand.motion), frames=60, wish=False, world=about)
    let_down = made.body.do("slerp", start)
    assert in_the_telephone(made, let_down, [lies] * len(let_down)) < 0.001
    hanging = Transform.of(grips(made.body.skeleton, let_down[-1].rotations, let_down[-1].root)[0])
    assert hanging.place[2] < 0.85
