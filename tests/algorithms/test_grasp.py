"""grasp: every finger at the wall, the thumb apart from the others; and the hand opened again."""

from __future__ import annotations

from itertools import product
from pathlib import Path

import numpy as np
import pytest
import trimesh
from msgspec.structs import replace

from ahmss.algorithm import HumanPose, Transform, frames
from ahmss.algorithm.messages import Goal, ObjectRecord, PoseRecord, ShapeRecord, SiteRecord, Start
from ahmss.body.array import Array
from ahmss.body.blending import blend
from ahmss.body.inverse import solve
from ahmss.body.kinematics import forward
from ahmss.body.links import INDEX, LINKS, fingers
from ahmss.body.quaternion import IDENTITY, conjugate, from_axis_angle, multiply, rotate, to_rotation_vector
from ahmss.database import Workspace
from ahmss.errors import AlgorithmError
from ahmss.grasping import power
from ahmss.grasping.field import Field
from ahmss.motion.fingers import Cylinder, closed
from ahmss.skills import grasping
from ahmss.skills.stepping import IMPORTANCE
from tests.demo.skin import Skin
from tests.grasping.shapes import kind, outside, thing

from .scene import CUP, DOOR, WORKSPACE, Body, frame_of, program, record

RADIUS, HEIGHT = 0.036, 0.095
TAP = "room/sink/tap"
MOST_POINTS = 100_000  # whose distances are had in a few milliseconds
MIDDLE = [INDEX[f"right_middle_{segment}"] for segment in ("proximal", "intermediate", "distal")]


def gaps(body: Body, side: str, axis: Transform) -> dict[str, float]:
    """The least distance of each finger link's skin from the cup's wall, metres."""
    places, turned = forward(body.rotations, body.root, body.skeleton.offsets)
    found = {}
    for link in fingers(side):
        along = np.linspace(0.0, 0.85, 29)[:, None] * body.skeleton.tips[link]  # the very tip is thinner
        seen = axis.inverse().apply(places[link] + rotate(turned[link], along))
        level, above = np.hypot(seen[:, 0], seen[:, 1]) - RADIUS, np.maximum(seen[:, 2] - HEIGHT, -seen[:, 2])
        apart = np.hypot(np.maximum(level, 0.0), np.maximum(above, 0.0)) + np.minimum(np.maximum(level, above), 0.0)
        found[LINKS[link]] = float(apart.min()) - body.skeleton.radii[link]
    return found


@pytest.mark.parametrize(("name", "side"), [("ken", "right"), ("aiko", "right"), ("ken", "left")])
def test_every_finger_touches_the_wall(name: str, side: str) -> None:
    body = Body(name, y=-0.3, facing=20.0) if side == "left" else Body(name)
    body.do("reach", body.start(CUP, "reach", hand=side))
    body.do("grasp", body.start(CUP, "grasp", hand=side))
    for link, gap in gaps(body, side, frame_of(CUP)).items():
        assert abs(gap) < 0.004, link
    palm = body.grip(0 if side == "right" else 1).place - frame_of(CUP).place
    assert np.hypot(*palm[:2]) == pytest.approx(RADIUS, abs=1.5e-3)


def test_the_thumb_goes_to_the_other_side() -> None:
    body = Body()
    body.do("reach", body.start(CUP, "reach"))
    body.do("grasp", body.start(CUP, "grasp"))
    places, _ = forward(body.rotations, body.root, body.skeleton.offsets)
    thumb, *others = (
        places[INDEX[f"right_{finger}_distal"]] - frame_of(CUP).place
        for finger in ("thumb", "index", "middle", "ring", "little")
    )
    for other in others:
        assert thumb[:2] @ other[:2] < 0.0


def test_no_bar_is_looked_for_where_a_hollow_thing_is_held_about_its_middle(monkeypatch: pytest.MonkeyPatch) -> None:
    looked = list[str]()
    monkeypatch.setattr(power, "hook", lambda *_: looked.append("there"))  # a tenth of a second in one frame
    body = Body()
    body.do("reach", body.start(CUP, "reach"))
    body.do("grasp", body.start(CUP, "grasp"))
    assert not looked
    assert max(abs(gap) for gap in gaps(body, "right", frame_of(CUP)).values()) < 0.004


@pytest.mark.parametrize("thing", ["cup", "bar", "box"])
def test_a_grip_is_looked_for_in_parts_and_meanwhile_the_hand_is_still(thing: str, tmp_path: Path) -> None:
    """None asks for the distances of more points than can be had within a frame."""
    if thing == "box":
        body, start, _, _ = before_a_box("ken", "right", tmp_path, (0.05, 0.06, 0.12))
    elif thing == "bar":
        body, start = at_site(DOOR, "lever", np.array([-0.07, 0.0, 0.0]))
    else:
        body = Body()
        body.do("reach", body.start(CUP, "reach"))
        start = body.start(CUP, "grasp")
    asked, grip = list[int](), body.grip().place
    clearance = Field.clearance

    def counted(field: Field, points: Array) -> Array:
        asked[-1] += points.size // 3
        return clearance(field, points)

    shown = list[HumanPose]()
    with pytest.MonkeyPatch.context() as patched:
        patched.setattr(Field, "clearance", counted)
        playing = frames(program("grasp"), replace(start, frames=30, wish=True))
        asked.append(0)
        for pose in playing:
            shown.append(pose)
            asked.append(0)
    assert max(asked) < MOST_POINTS
    found = max(k for k, count in enumerate(asked) if count)
    assert found > 2
    for pose in shown[:found]:
        np.testing.assert_allclose(pose.targets[0, :3], grip, atol=1e-9)
    assert len(shown) >= 29 + found


@pytest.mark.parametrize(
    ("wide", "name", "side"),
    [
        case if case in (("40", "aiko", "right"), ("60", "ken", "left"), ("100", "aiko", "left"))
        else pytest.param(*case, marks=pytest.mark.long)
        for case in product(("40", "60", "90", "100", "110"), ("ken", "aiko"), ("right", "left"))
    ],
)  # fmt: skip
def test_the_thumb_is_on_the_wall_of_a_cup_and_not_over_its_rim(
    wide: str, name: str, side: str, tmp_path: Path
) -> None:
    """Of cups so wide, millimetres, all as tall; and against the fingers, none of which is deep in it."""
    corners = kind("cup") * np.array([float(wide) / 72.0, float(wide) / 72.0, 1.0])
    home = tmp_path / "objectdb" / "wide"
    home.mkdir(parents=True)
    flat = corners.reshape(-1, 3)
    trimesh.Trimesh(flat, np.arange(len(flat)).reshape(-1, 3), process=False).export(home / "it.stl")
    (home / "object.toml").write_text('name = "wide"\nshape = "it.stl"\nunit = "m"\n')
    kept = Workspace(tmp_path).objects.kept_shape("wide")
    assert kept is not None
    body, frame = Body(name, facing=0.0), Transform(np.array([0.4, -0.12 if side == "right" else 0.12, 0.88]), IDENTITY)
    sites = {"wall": SiteRecord((0.0, 0.0, 0.052), (1.0, 0.0, 0.0, 0.0), "z", "power")}
    cup = ObjectRecord(
        5, "wide", "wide", tuple(frame.place), tuple(frame.rotation), sites, {"diameter": 0.001 * float(wide)}, {},
        shape=ShapeRecord(str(kept[0]), kept[1]),
    )  # fmt: skip
    for algorithm, length in (("reach", 0), ("grasp", 30)):
        pose = PoseRecord.of(body.rotations, body.root)
        body.do(algorithm, Start(
            kind="human", human=body.skeleton.to_record(), pose=pose, frames=length, object=cup, site="wall", hand=side,
            wish=True,
        ))  # fmt: skip
    skin = Skin.read(WORKSPACE.humans.shape(name).glb, body.skeleton)
    chosen = np.flatnonzero(np.isin(skin.link, fingers(side)))
    points = frame.inverse().apply(skin.posed(body.rotations, body.root, chosen))
    gaps = outside(points, corners)
    assert gaps.min() > -0.002, LINKS[skin.link[chosen[gaps.argmin()]]]
    thumb = np.isin(skin.link[chosen], [INDEX[f"{side}_thumb_proximal"], INDEX[f"{side}_thumb_distal"]])
    on = gaps < 0.003
    assert points[on & thumb, 2].max() < HEIGHT - 0.005
    out = points[:, :2] / np.linalg.norm(points[:, :2], axis=1, keepdims=True)
    assert float((out[on & thumb] @ out[on & ~thumb].T).min()) < -0.8


def test_a_thicker_object_bends_the_fingers_less() -> None:
    bent = {}
    for diameter in (0.05, 0.09):
        body = Body()
        body.do("reach", body.start(CUP, "reach"))
        body.do("grasp", body.start(CUP, "grasp", parameters={"diameter": diameter}))
        links = [INDEX["right_middle_proximal"], INDEX["right_middle_intermediate"], INDEX["right_middle_distal"]]
        bent[diameter] = float(np.arccos(np.abs(body.rotations[links, 0])).sum())
    assert bent[0.05] > bent[0.09] + 0.2


def at_site(name: str, site: str, away: Array, side: str = "right") -> tuple[Body, Start]:
    """A human who stands before a site of an object, the palm facing it from a step (3,) in the site's frame."""
    thing = record(name, shaped=True)
    named = thing.sites[site]
    at = frame_of(name).then(Transform(np.array(named.position), np.array(named.rotation)))
    ahead = rotate(at.rotation, np.array([1.0, 0.0, 0.0]))
    level = ahead * np.array([1.0, 1.0, 0.0])
    shoulder = 0.12 * np.array([-level[1], level[0], 0.0]) * (1.0 if side == "right" else -1.0)
    x, y, _ = at.place - 0.32 * level + shoulder
    body = Body(x=float(x), y=float(y), facing=float(np.degrees(np.arctan2(level[1], level[0]))))
    targets = np.zeros((5, 8))
    row = 0 if side == "right" else 1
    targets[row, :3], targets[row, 3:7], targets[row, 7] = at.apply(away), at.rotation, 1.0
    body.rotations = solve(body.skeleton, body.rotations, body.root, targets)
    pose = PoseRecord.of(body.rotations, body.root)
    skeleton = body.skeleton.to_record()
    return body, Start(
        kind="human", human=skeleton, pose=pose, frames=30, object=thing, site=site, hand=side,
    )  # fmt: skip


@pytest.mark.parametrize("side", ["right", "left"])
def test_a_lever_is_gripped_by_its_own_shape(side: str) -> None:
    body, start = at_site(DOOR, "lever", np.array([-0.07, 0.0, 0.0]), side)
    body.do("grasp", start)
    places, turned = forward(body.rotations, body.root, body.skeleton.offsets)
    at = frame_of(DOOR).inverse()
    near: dict[str, float] = {}
    for link in fingers(side):
        along = np.linspace(0.0, 0.85, 12)[:, None] * body.skeleton.tips[link]
        points = at.apply(places[link] + rotate(turned[link], along))
        gap = float((outside(points, thing("lever").near) - body.skeleton.radii[link]).min())
        assert gap > -0.002, LINKS[link]
        finger = LINKS[link].split("_")[1]
        near[finger] = min(gap, near.get(finger, 1.0))
    assert near["thumb"] < 0.002
    assert sum(gap < 0.002 for gap in near.values()) == 5


@pytest.mark.parametrize(("name", "side"), [("ken", "right"), ("ken", "left"), ("aiko", "right"), ("aiko", "left")])
def test_a_box_is_between_thumb_and_fingers_where_the_wrist_can_not_come_from_the_front(
    name: str, side: str, tmp_path: Path
) -> None:
    """Its sides are to the left and right: squarely behind it the wrist would be bent by a right angle."""
    body, start, frame, corners = before_a_box(name, side, tmp_path, (0.05, 0.06, 0.12))
    body.do("grasp", start)
    places, turned = forward(body.rotations, body.root, body.skeleton.offsets)
    on: dict[str, float] = {}
    for link in fingers(side):
        along = np.linspace(0.0, 0.9, 12)[:, None] * body.skeleton.tips[link]
        points = frame.inverse().apply(places[link] + rotate(turned[link], along))
        gap = outside(points, corners) - body.skeleton.radii[link]
        assert gap.min() > -0.002, LINKS[link]
        if gap.min() < 0.002:
            on[LINKS[link].split("_")[1]] = float(np.sign(points[gap.argmin(), 1]))
    assert on["index"] == on["middle"] == -on["thumb"], on


def test_what_the_arm_can_not_come_to_is_told(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(grasping, "bent_towards", lambda _reacher, _hips, _root, spine, _wrist: spine)  # a stiff waist
    body, start, _, _ = before_a_box("ken", "right", tmp_path, (0.05, 0.06, 0.12), at=(0.5, -0.15))
    with pytest.raises(AlgorithmError, match=r"right arm can't bring the hand to where it holds box: it misses by \d"):
        body.do("grasp", start)


def before_a_box(
    name: str, side: str, folder: Path, size: tuple[float, float, float], at: tuple[float, float] = (0.42, -0.15)
) -> tuple[Body, Start, Transform, Array]:
    """Who has brought a palm before a box whose sides to the left and right are gripped; its frame and triangles."""
    mirrored = 1.0 if side == "right" else -1.0
    body, frame = Body(name, facing=-20.0 * mirrored), Transform(np.array([at[0], mirrored * at[1], 0.88]), IDENTITY)
    mesh = trimesh.creation.box(extents=size)
    mesh.apply_translation([0.0, 0.0, 0.5 * size[2]])
    home = folder / "objectdb" / "box"
    home.mkdir(parents=True)
    mesh.export(home / "box.stl")
    (home / "object.toml").write_text('name = "box"\nshape = "box.stl"\nunit = "m"\n')
    kept = Workspace(folder).objects.kept_shape("box")
    assert kept is not None
    site = SiteRecord((0.0, 0.0, 0.07), (0.5**0.5, 0.5**0.5, 0.0, 0.0), "", "precision")
    thing = ObjectRecord(
        5, "box", "box", tuple(frame.place), tuple(frame.rotation), {"sides": site}, {}, {},
        shape=ShapeRecord(str(kept[0]), kept[1]),
    )  # fmt: skip
    targets = np.zeros((5, 8))
    row = 0 if side == "right" else 1
    targets[row, :3] = frame.apply(np.array([-0.06, 0.0, 0.07]))
    targets[row, 3:7], targets[row, 7] = [np.cos(0.45), -mirrored * np.sin(0.45), 0.0, 0.0], 1.0
    body.rotations = solve(body.skeleton, body.rotations, body.root, targets)
    start = Start(
        kind="human", human=body.skeleton.to_record(), pose=PoseRecord.of(body.rotations, body.root), frames=30,
        object=thing, site="sides", hand=side,
    )  # fmt: skip
    return body, start, frame, np.array(mesh.vertices[mesh.faces])


@pytest.mark.parametrize("name", ["ken", "aiko"])
def test_thumb_and_fingers_come_round_a_box_that_they_pinch(name: str, tmp_path: Path) -> None:
    """The site is in its middle: the hand stops before it, and goes out again as it turns to its sides."""
    size = (0.05, 0.06, 0.12)
    _, grasped, _, corners = before_a_box(name, "right", tmp_path, size)
    assert grasped.object is not None
    frame = Transform(np.array([0.42, -0.15, 0.88]), IDENTITY)
    box = replace(
        grasped.object, place=tuple(frame.place), rotation=tuple(frame.rotation), properties={"size": list(size)}
    )
    body, deepest = Body(name), 1.0
    links = [INDEX["right_hand"], *fingers("right")]
    for algorithm, length in (("reach", 0), ("grasp", 30)):
        pose = PoseRecord.of(body.rotations, body.root)
        for one in body.do(algorithm, replace(grasped, object=box, pose=pose, frames=length))[::2]:
            places, turned = forward(one.rotations, one.root, body.skeleton.offsets)
            along = np.linspace(0.0, 0.85, 6)[:, None, None] * body.skeleton.tips[links]
            points = frame.inverse().apply(places[links] + rotate(turned[links], along))
            gaps = outside(points.reshape(-1, 3), corners).reshape(points.shape[:2])
            deepest = min(deepest, float((gaps - body.skeleton.radii[links])[:, 1:].min()))
    assert -0.002 < deepest < 0.002  # and touches it in the end


def test_a_tap_is_taken_between_thumb_and_fingers_and_let_go_along_the_way_it_came() -> None:
    body, start = at_site(TAP, "handle", np.array([-0.1, 0.0, 0.0]))
    body.do("grasp", start)
    before = body.grip().place
    again = replace(start, pose=PoseRecord.of(body.rotations, body.root), frames=40, parameters={"open": True})
    body.do("grasp", again)
    ahead = rotate(frame_of(TAP).rotation, np.array([-1.0, 0.0, 0.0]))
    np.testing.assert_allclose(body.grip().place - before, -0.06 * ahead, atol=3e-3)


def test_a_curled_hand_opens_before_it_closes() -> None:
    body = Body()
    body.do("reach", body.start(CUP, "reach"))
    fist = closed(body.skeleton, "right", Cylinder(np.array([0.09, -0.03, 0.0]), np.array([0.0, 0.0, 1.0]), 0.01))
    body.rotations[list(fingers("right"))] = fist
    shown = body.do("grasp", body.start(CUP, "grasp"))
    bent = [float(np.arccos(np.abs(pose.rotations[MIDDLE, 0])).sum()) for pose in shown]
    assert min(bent) < bent[-1] - 0.1
    assert bent[0] > bent[-1] + 0.2


def test_what_is_too_wide_for_a_hand_is_told() -> None:
    body = Body()
    body.do("reach", body.start(CUP, "reach"))
    start = body.start(CUP, "grasp")
    kept = WORKSPACE.objects.kept_shape("carton")  # where the cup is: the palm is at its middle
    assert kept is not None
    assert start.object is not None
    wide = replace(start.object, shape=ShapeRecord(str(kept[0]), kept[1]))
    with pytest.raises(AlgorithmError, match="can't close around room/cup there; it spans"):
        list(frames(program("grasp"), replace(start, object=wide)))


def test_without_a_shape_and_a_diameter_it_says_what_is_missing() -> None:
    _, start = at_site(DOOR, "lever", np.array([-0.07, 0.0, 0.0]))
    assert start.object is not None
    with pytest.raises(AlgorithmError, match="needs room/doorway/door's shape or its diameter"):
        list(frames(program("grasp"), replace(start, object=replace(start.object, shape=None))))


def test_it_says_so_when_the_cup_is_out_of_reach() -> None:
    body = Body()
    with pytest.raises(AlgorithmError, match=r"reach for it first, .* `with cup reach then cup grasp`"):
        list(frames(program("grasp"), body.start(CUP, "grasp")))


def test_opened_fingers_leave_the_wall_before_the_hand_goes() -> None:
    body = Body()
    body.do("reach", body.start(CUP, "reach"))
    body.do("grasp", body.start(CUP, "grasp"))
    before = body.grip().place
    start = body.start(CUP, "release")
    shown = body.do("grasp", start)
    assert np.linalg.norm(body.grip().place - before) == pytest.approx(0.06, abs=2e-3)
    half = Body()
    for pose in shown:
        half.rotations, half.root = pose.rotations, pose.root
        assert min(gaps(half, "right", frame_of(CUP)).values()) > -0.004


def test_only_the_arm_and_its_fingers_are_cared_for() -> None:
    body = Body()
    body.do("reach", body.start(CUP, "reach"))
    pose = next(iter(frames(program("grasp"), body.start(CUP, "grasp"))))
    for name in ("hips", "left_hand", "right_upper_leg", "left_index_distal"):
        assert pose.importance[INDEX[name]] == 0.0
    assert pose.importance[43] == 0.0


def test_what_a_walk_had_of_a_bent_waist_is_too_little_to_be_seen_when_the_walk_ends() -> None:
    body, spine = Body(), INDEX["spine"]
    body.do("reach", body.start(CUP, "reach"))
    upright = body.rotations[spine].copy()
    bent = multiply(upright, from_axis_angle(np.array([0.0, 1.0, 0.0]), 0.7))
    body.rotations[spine] = bent
    start = body.start(CUP, "grasp", frame=body.grip().then(Transform(np.array([0.04, 0.0, -0.05]), IDENTITY)))
    pose = next(iter(frames(program("grasp"), replace(start, carried=True))))
    walk = body.rotations.copy()
    walk[spine] = upright
    both = blend(np.stack([pose.rotations, walk]), np.stack([pose.importance[:43], IMPORTANCE[:43]]), body.rotations)
    alone = blend(pose.rotations[None], pose.importance[None, :43], body.rotations)
    turn = np.linalg.norm(to_rotation_vector(multiply(conjugate(both[spine]), alone[spine])))
    assert 0.0 < np.degrees(turn) < 0.1


@pytest.mark.parametrize("wish", [True, False])
def test_arm_and_fingers_turn_no_faster_than_people_do_to_a_box_beside_them(wish: bool, tmp_path: Path) -> None:
    """The palm, brought there as the site is turned, turns by a right angle; where nobody asked for so few frames it
    takes more of them.
    """
    size = (0.05, 0.06, 0.12)
    _, grasped, _, _ = before_a_box("ken", "right", tmp_path, size)
    assert grasped.object is not None
    box, body = replace(grasped.object, properties={"size": list(size)}), Body("ken")
    shown: list[list[Array]] = []
    grasped = replace(grasped, goal=Goal(rotation=grasped.object.sites["sides"].rotation))
    for algorithm, length in (("reach", 0), ("grasp", 30)):
        pose = PoseRecord.of(body.rotations, body.root)
        start = replace(grasped, object=box, pose=pose, frames=length, wish=wish or algorithm == "reach")
        shown.append([body.rotations, *(one.rotations for one in body.do(algorithm, start))])
    hand = np.array(shown[1])[:, [*range(INDEX["right_upper_arm"], INDEX["right_hand"] + 1), *fingers("right")]]
    turned = 2.0 * np.degrees(np.arccos(np.clip(np.abs((hand[1:] * hand[:-1]).sum(axis=-1)), 0.0, 1.0)))
    assert 3.0 < turned.max() < 6.0
    assert len(turned) > 33 if wish else len(turned) == 30
