"""Gestures look as people's do: how far, how long, and back to where one stood."""

from __future__ import annotations

import itertools

import msgspec
import numpy as np
import pytest

from ahmss.algorithm import HumanPose, frames
from ahmss.algorithm.messages import ObjectRecord, PoseRecord, SiteRecord, Start
from ahmss.algorithm.place import WorldObject
from ahmss.algorithm.task import HumanTask
from ahmss.body.array import Array
from ahmss.body.inverse import grips, solve
from ahmss.body.kinematics import forward
from ahmss.body.links import INDEX
from ahmss.body.quaternion import conjugate, multiply, rotate, to_rotation_vector
from ahmss.errors import AlgorithmError
from ahmss.motion.gestures import GESTURES, arm_to
from ahmss.motion.planting import feet
from ahmss.reaching.prism import clearance
from ahmss.reaching.reacher import Reacher
from ahmss.reaching.skin import arm_skin
from ahmss.reaching.standing import centre_of_mass, support
from ahmss.reaching.trunk import trunk_points
from ahmss.skills.box import filled
from tests.algorithms.devices import at, device
from tests.algorithms.reached import prisms
from tests.algorithms.scene import WORKSPACE, Body, program

BODIES = ("ken", "aiko")
UP = np.array([0.0, 0.0, 1.0])


def start_of(
    body: Body, which: str, *, frames: int = 0, whom: tuple[float, float] | None = None, **given: object
) -> Start:
    """START of a gesture, by oneself or to somebody whose eyes are 1.6 m over a place on the floor."""
    other = None
    if whom is not None:
        sites = {"eyes": SiteRecord((0.0, 0.0, 1.6), id=1 << 40)}
        states = {"oneself": "yes"} if given.pop("oneself", False) else {}
        other = ObjectRecord(-2, "mari", "human", (*whom, 0.0), (1.0, 0.0, 0.0, 0.0), sites, states=states)
    busy = given.pop("busy", [])
    return Start(
        kind="human", human=body.skeleton.to_record(), pose=PoseRecord.of(body.rotations, body.root), frames=frames,
        object=other, parameters={"which": which, **given}, busy=busy,  # type: ignore[arg-type]
    )  # fmt: skip


def made(name: str, which: str, **given: object) -> tuple[Body, list[HumanPose]]:
    body = Body(name, facing=0.0)
    return body, body.do("gesture", start_of(body, which, **given))  # type: ignore[arg-type]


def head_turns(body: Body, shown: list[HumanPose], begun: Array) -> Array:
    """Yaw, pitch and roll (n, 3) of the head against the trunk since the beginning, degrees."""
    heads = np.array([pose.rotations[INDEX["head"]] for pose in shown])
    return np.degrees(to_rotation_vector(multiply(conjugate(begun[INDEX["head"]]), heads)))


@pytest.mark.parametrize("which", GESTURES)
@pytest.mark.parametrize("name", BODIES)
def test_each_ends_where_it_began_and_moves_like_a_body(name: str, which: str) -> None:
    begun = Body(name, facing=0.0)
    body, shown = made(name, which)
    assert len(shown) == round(60 * GESTURES[which].seconds)
    rotations = np.array([begun.rotations, *(pose.rotations for pose in shown)])
    off = to_rotation_vector(multiply(conjugate(rotations[0]), rotations[-1]))
    assert np.degrees(np.linalg.norm(off, axis=-1)).max() < 1.0
    steps = to_rotation_vector(multiply(conjugate(rotations[:-1]), rotations[1:]))
    assert np.degrees(np.linalg.norm(steps, axis=-1)).max() < 9.0
    jumps = np.linalg.norm(np.diff(steps, axis=0), axis=-1)
    assert np.degrees(jumps).max() < 1.5
    limits = body.skeleton.limits[3:6]
    assert np.isfinite(limits).all()


@pytest.mark.parametrize("name", BODIES)
def test_a_nod_goes_down_twice_and_a_shake_from_side_to_side(name: str) -> None:
    begun = Body(name, facing=0.0).rotations
    body, shown = made(name, "nod")
    pitch = head_turns(body, shown, begun)[:, 1]
    assert 14.0 < pitch.max() < 20.0
    assert pitch.min() > -1.0
    assert lows(-pitch) == 2
    body, shown = made(name, "shake_head")
    yaw = head_turns(body, shown, begun)[:, 0]
    assert 13.0 < yaw.max() < 22.0
    assert -22.0 < yaw.min() < -10.0
    assert len(shown) < 120


def lows(values: Array) -> int:
    """How often a course has a low that matters."""
    inner = values[1:-1]
    return int(((inner < values[:-2]) & (inner <= values[2:]) & (inner < -4.0)).sum())


@pytest.mark.parametrize("name", BODIES)
@pytest.mark.parametrize("degrees", [15.0, 30.0, 45.0])
def test_a_bow_is_so_deep_and_the_weight_stays_over_the_feet(name: str, degrees: float) -> None:
    begun = Body(name, facing=0.0)
    body, shown = made(name, "bow", degrees=degrees)
    assert 120 <= len(shown) <= 180
    rotations = np.array([pose.rotations for pose in shown])
    root = np.array([pose.root for pose in shown])
    trunk = multiply(rotations[:, 0], rotations[:, INDEX["spine"]])
    upright = multiply(begun.rotations[0], begun.rotations[INDEX["spine"]])
    lean = np.degrees(np.linalg.norm(to_rotation_vector(multiply(trunk, conjugate(upright))), axis=-1))
    assert lean.max() == pytest.approx(degrees, abs=1.5)
    ahead = rotate(trunk[lean.argmax()], np.array([1.0, 0.0, 0.0]))
    assert ahead[0] > 0.9 * np.sin(np.radians(degrees))  # forward
    planted = feet(body.skeleton, begun.rotations, begun.root)
    moved = feet(body.skeleton, rotations, root)[:, :, :3] - planted[:, :3]
    assert np.abs(moved).max() < 0.002
    centre = centre_of_mass(body.skeleton, rotations, root)[:, :2]
    low, high = support(body.skeleton, planted, 0.0, (0.0, 1.0), 1.0)
    assert (centre > low - 0.005).all()
    assert (centre < high + 0.005).all()
    deepest = int(lean.argmax())
    places, _ = forward(rotations[deepest], root[deepest], body.skeleton.offsets)
    for side in ("right", "left"):  # the arms hang
        arm = places[INDEX[f"{side}_hand"]] - places[INDEX[f"{side}_upper_arm"]]
        assert np.degrees(np.arccos(-arm[2] / np.linalg.norm(arm))) < 25.0


@pytest.mark.parametrize("name", BODIES)
def test_a_hand_waves_beside_the_head_palm_ahead(name: str) -> None:
    body, shown = made(name, "wave")
    palms = np.array([grips(body.skeleton, pose.rotations, pose.root)[0] for pose in shown])
    middle = palms[50:140]
    eyes = 0.936 * body.skeleton.stature
    assert (middle[:, 2] > 0.78 * body.skeleton.stature).all()
    assert (middle[:, 2] < eyes + 0.1).all()
    assert (middle[:, 1] < -0.15).all()  # on its own side
    assert (rotate(middle[:, 3:], np.array([1.0, 0.0, 0.0]))[:, 0] > 0.8).all()
    assert np.ptp(middle[:, 1]) > 0.12
    assert lows(100.0 * (middle[:, 1] - middle[:, 1].mean())) == 3


@pytest.mark.parametrize("name", BODIES)
def test_a_thumb_points_up_out_of_a_fist(name: str) -> None:
    body, shown = made(name, "thumbs_up")
    pose = shown[len(shown) // 2]
    places, world = forward(pose.rotations, pose.root, body.skeleton.offsets)
    tip = places[INDEX["right_thumb_distal"]] + rotate(
        world[INDEX["right_thumb_distal"]], body.skeleton.tips[INDEX["right_thumb_distal"]]
    )
    thumb = tip - places[INDEX["right_thumb_proximal"]]
    assert thumb[2] / np.linalg.norm(thumb) > 0.85
    for finger in ("index", "middle", "ring", "little"):
        knuckle, end = (places[INDEX[f"right_{finger}_{part}"]] for part in ("proximal", "distal"))
        assert np.linalg.norm(end - knuckle) < 0.055
        assert tip[2] > knuckle[2] + 0.02


@pytest.mark.parametrize("name", BODIES)
def test_who_thinks_has_a_hand_at_the_chin_and_the_elbow_in_the_other(name: str) -> None:
    body, shown = made(name, "think")
    pose = shown[len(shown) // 2]
    places, world = forward(pose.rotations, pose.root, body.skeleton.offsets)
    head = INDEX["head"]
    chin = places[head] + rotate(world[head], body.skeleton.eye) - 0.068 * body.skeleton.stature * UP
    palms = grips(body.skeleton, pose.rotations, pose.root)
    assert np.linalg.norm(palms[0, :3] - chin) < 0.135  # the curled fingers are between
    assert np.linalg.norm(palms[1, :3] - places[INDEX["right_lower_arm"]]) < 0.16
    for side, sign in (("right", -1.0), ("left", 1.0)):  # no arm goes through the trunk
        assert sign * places[INDEX[f"{side}_lower_arm"], 1] > 0.14


def test_shoulders_stay_and_both_palms_turn_up_in_a_shrug() -> None:
    body, shown = made("ken", "shrug")
    pose = shown[45]
    palms = grips(body.skeleton, pose.rotations, pose.root)
    out = rotate(palms[:, 3:], np.array([1.0, 0.0, 0.0]))
    assert (out[:, 2] > 0.85).all()
    assert palms[0, 1] < -0.3 < 0.3 < palms[1, 1]


def test_somebody_is_looked_at_wherever_they_go_and_nodded_to_there() -> None:
    body = Body("ken", facing=0.0)
    start = start_of(body, "nod", frames=60, whom=(2.0, 2.0))
    looked: list[Array] = []
    walks = [np.array([2.0, 2.0 - 0.02 * k, 1.6]) for k in range(60)]
    task = HumanTask(start)
    poses = program("gesture")(task)
    for k, place in enumerate(walks, 1):
        task.see(np.concatenate([body.row(k), [1 << 40], place, [1.0, 0.0, 0.0, 0.0]]))
        pose = HumanPose.of(next(poses)[0])
        rotations = solve(body.skeleton, body.rotations, body.root, pose.targets)
        _, world = forward(rotations, body.root, body.skeleton.offsets)
        looked.append(rotate(world[INDEX["head"]], -UP))
    bearing = np.degrees([np.arctan2(way[1], way[0]) for way in looked])
    wanted = np.degrees([np.arctan2(place[1], place[0]) for place in walks])
    assert np.abs(bearing[20:40] - wanted[20:40]).max() < 8.0
    pitch = np.degrees([-np.arcsin(way[2]) for way in looked])
    assert 8.0 < pitch[5:55].max() - pitch[5:55].min() < 24.0


@pytest.mark.parametrize(
    ("which", "given", "reason"),
    [
        ("curtsy", {}, 'no gesture "curtsy"; there are: nod'),
        ("shrug", {"busy": ["left"]}, "the left hand holds something, and this takes both"),
        (
            "wave",
            {"whom": (-2.0, 0.1)},
            "mari is 17[0-9] degrees aside, behind the back; turn to it first",
        ),
    ],
)
def test_what_can_not_be_made_is_refused_in_a_sentence(which: str, given: dict[str, object], reason: str) -> None:
    body = Body("ken", facing=0.0)
    with pytest.raises(AlgorithmError, match=reason):
        list(itertools.islice(frames(program("gesture"), start_of(body, which, **given)), 5))  # type: ignore[arg-type]


def test_who_holds_something_waves_with_the_other_hand() -> None:
    body, shown = made("ken", "wave", busy=["right"])
    assert grips(body.skeleton, shown[90].rotations, shown[90].root)[1, 2] > 1.3
    assert grips(body.skeleton, shown[90].rotations, shown[90].root)[0, 2] < 1.0


@pytest.mark.parametrize("name", BODIES)
def test_the_head_takes_longer_to_who_is_farther_aside(name: str) -> None:
    begun = Body(name, facing=0.0)
    _, shown = made(name, "wave", whom=(0.2, 2.0))
    rotations = np.array([begun.rotations, *(pose.rotations for pose in shown)])
    _, turned = forward(rotations, np.repeat(begun.root[None], len(rotations), axis=0), begun.skeleton.offsets)
    steps = multiply(conjugate(turned[:-1, INDEX["head"]]), turned[1:, INDEX["head"]])
    fastest = np.degrees(np.linalg.norm(to_rotation_vector(steps), axis=-1)).max()
    assert 3.0 < fastest < 3.5


def test_one_bows_as_oneself_wherever_the_world_has_last_seen_one() -> None:
    """Where one stands is known a frame late, and who has bent is elsewhere: it is no place to turn to."""
    body, shown = made("ken", "bow", whom=(-0.3, 0.05), oneself=True)
    assert len(shown) == round(60 * GESTURES["bow"].seconds)
    with pytest.raises(AlgorithmError, match="behind the back"):
        made("ken", "bow", whom=(-0.3, 0.05))
    assert body.root[2] > 0.5


@pytest.mark.parametrize("which", ["wave", "shrug", "thumbs_up", "think"])
@pytest.mark.parametrize(("name", "x", "facing"), [("ken", 0.3, 180.0), ("ken", 0.28, 200.0), ("aiko", 0.28, 200.0)])
def test_who_stands_close_to_a_panel_keeps_the_arms_out_of_it(name: str, x: float, facing: float, which: str) -> None:
    """They were 44 to 94 mm in it."""
    panel, walks = device("panel", at(0.0, 0.0, 0.0)), str(WORKSPACE.objects.get("human").affordances[which].motion)
    body, blocks = Body(name, x, 0.1, facing), filled(WorldObject.of(panel))
    shown = body.do("gesture", msgspec.structs.replace(start_of(body, which), world=[panel], motion=walks))
    rotations, root = np.array([pose.rotations for pose in shown]), np.array([pose.root for pose in shown])
    for side in ("right", "left"):
        points, radii = arm_skin(Reacher.of(body.skeleton, side), rotations, root)
        assert (clearance(blocks, points) - radii).min() > -0.002, side
    arms = slice(INDEX["right_upper_arm"], INDEX["left_hand"] + 1)
    turned = to_rotation_vector(multiply(conjugate(rotations[:-1, arms]), rotations[1:, arms]))
    assert np.degrees(np.linalg.norm(turned, axis=-1)).max() < 9.0


@pytest.mark.parametrize("name", BODIES)
def test_a_hand_that_is_held_up_before_a_display_does_not_go_through_it_as_one_bows(name: str) -> None:
    """It went 20 mm into it, and out of its back."""
    body, palm = Body(name, 0.5, 0.0, 180.0), GESTURES["thumbs_up"].main
    assert palm is not None
    arm = slice(INDEX["right_upper_arm"], INDEX["right_hand"] + 1)
    body.rotations[arm] = arm_to(body.skeleton, "right", palm)
    hand, _ = arm_skin(Reacher.of(body.skeleton, "right"), body.rotations, body.root)
    ahead = float(hand[:, 0].min()) - 0.04  # the panel is so far before the foremost point of the hand
    panel = device("touch_panel", at(ahead, float(hand[hand[:, 0].argmin(), 1]), float(hand[:, 2].min())))
    walks = str(WORKSPACE.objects.get("human").affordances["bow"].motion)
    shown = body.do("gesture", msgspec.structs.replace(start_of(body, "bow"), world=[panel], motion=walks))
    rotations, root = np.array([pose.rotations for pose in shown]), np.array([pose.root for pose in shown])
    points, radii = arm_skin(Reacher.of(body.skeleton, "right"), rotations, root)
    blocks = prisms(panel)
    assert (clearance(blocks, points) - radii).min() > -0.002


@pytest.mark.parametrize(("name", "facing", "busy"), [("ken", 180.0, []), ("aiko", 200.0, ["right", "left"])])
def test_who_bows_before_a_panel_steps_back_for_the_head_not_to_be_in_it(
    name: str, facing: float, busy: list[str]
) -> None:
    """It was up to 110 mm in its plate."""
    panel, walks = device("panel", at(0.0, 0.0, 0.0)), str(WORKSPACE.objects.get("human").affordances["bow"].motion)
    body, blocks = Body(name, 0.3, 0.1, facing), filled(WorldObject.of(panel))
    told = start_of(body, "bow", degrees=60.0, busy=busy)
    shown = body.do("gesture", msgspec.structs.replace(told, world=[panel], motion=walks))
    points, radii = trunk_points(
        body.skeleton, np.array([pose.rotations for pose in shown]), np.array([pose.root for pose in shown])
    )
    assert (clearance(blocks, points) - radii).min() > -0.002
