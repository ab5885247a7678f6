"""A box, a knob and a mug straight ahead, turned this way and that: reached for and held, as the skin is shown."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from pathlib import Path

import numpy as np
import pytest
import trimesh
from msgspec.structs import replace

from ahmss.algorithm import HumanPose, Transform
from ahmss.algorithm.messages import ObjectRecord, PoseRecord, ShapeRecord, SiteRecord, Start
from ahmss.body.array import Array
from ahmss.body.links import INDEX, LINKS, fingers
from ahmss.body.quaternion import from_axis_angle, rotate
from ahmss.database import Workspace
from ahmss.errors import AlgorithmError
from ahmss.skills import grasping
from tests.demo.skin import Skin
from tests.grasping.shapes import box, lathe, mug, outside

from .scene import WORKSPACE, Body

DEEPEST = 0.002  # metres that skin may be in the thing, in any frame
TOUCHES, LOOSELY, OPPOSITE = (
    0.003,
    0.005,
    -0.6,
)  # metres, in a loop; cosine between the normals under the thumb and under the fingers
AT, SITE = np.array([0.42, 0.0, 0.88]), SiteRecord((0.0, 0.0, 0.07), (0.5**0.5, 0.5**0.5, 0.0, 0.0), "", "precision")
KNOB = [(0.0, 0.0), (0.012, 0.0), (0.012, 0.05), (0.025, 0.055), (0.025, 0.08), (0.0, 0.085)]
UP = np.array([0.0, 0.0, 1.0])
SIZES = {"box": [0.05, 0.06, 0.12], "knob": [0.05, 0.05, 0.085]}
HANDS = [("ken", "right"), ("ken", "left"), ("aiko", "right"), ("aiko", "left")]
TURNS = (-40, -20, 0, 20, 40)
IN_SHORT = {
    ("box", "aiko", "right", 0),
    ("box", "aiko", "left", 20),
    ("box", "ken", "left", 0),
    ("knob", "ken", "right", 40),
}
CASES = [(name, *hand, turn) for name in SIZES for hand in HANDS for turn in TURNS]


def triangles(name: str) -> Array:
    return box(1.0) * np.array([*SIZES["box"][:2], 1.0]) if name == "box" else lathe(KNOB)


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A workspace with both kinds."""
    made = tmp_path_factory.mktemp("kinds")
    for name in SIZES:
        home = made / "objectdb" / name
        home.mkdir(parents=True)
        corners = triangles(name).reshape(-1, 3)
        trimesh.Trimesh(corners, np.arange(len(corners)).reshape(-1, 3), process=False).export(home / "it.stl")
        (home / "object.toml").write_text(f'name = "{name}"\nshape = "it.stl"\nunit = "m"\n')
    return made


@dataclass(frozen=True)
class Pinched:
    """What was shown of a reach and then of a grasp, of a thing there."""

    reached: list[HumanPose]
    grasped: list[HumanPose]
    frame: Transform
    near: Array


def pinched(folder: Path, name: str, who: str, side: str, turn: float) -> Pinched:
    frame = Transform(AT, from_axis_angle(UP, np.array(np.radians(turn))))
    kept = Workspace(folder).objects.kept_shape(name)
    assert kept is not None
    half = 0.5 * np.array(SIZES[name][:2])
    ring = tuple((x * half[0], y * half[1]) for x, y in ((-1, -1), (1, -1), (1, 1), (-1, 1)))
    record = ObjectRecord(
        5, name, name, tuple(frame.place.tolist()), tuple(frame.rotation.tolist()), {"sides": SITE},
        {"size": SIZES[name]}, {}, footprint=(ring,), shape=ShapeRecord(str(kept[0]), kept[1]),
    )  # fmt: skip
    body = Body(who, facing=0.0)
    start = Start(
        kind="human", human=body.skeleton.to_record(), pose=PoseRecord.of(body.rotations, body.root), frames=0,
        object=record, site="sides", hand=side,
    )  # fmt: skip
    reached = body.do("reach", start)
    pose = PoseRecord.of(body.rotations, body.root)
    return Pinched(reached, body.do("grasp", replace(start, pose=pose, frames=30)), frame, triangles(name))


@cache
def skin(who: str) -> Skin:
    return Skin.read(WORKSPACE.humans.shape(who).glb, WORKSPACE.humans.get(who).skeleton)


def seen(of: Skin, pose: HumanPose, frame: Transform, chosen: Array) -> Array:
    return frame.inverse().apply(of.posed(pose.rotations, pose.root, chosen))


@pytest.mark.parametrize(
    ("name", "who", "side", "turn"),
    [case if case in IN_SHORT else pytest.param(*case, marks=pytest.mark.long) for case in CASES],
)
def test_it_is_held_from_both_sides_and_no_skin_is_ever_in_it(
    folder: Path, name: str, who: str, side: str, turn: int
) -> None:
    made = pinched(folder, name, who, side, turn)
    of = skin(who)
    links = [INDEX["head"], INDEX[f"{side}_lower_arm"], INDEX[f"{side}_hand"], *fingers(side)]
    chosen = np.flatnonzero(np.isin(of.link, links))
    shown = [*made.reached[::4], *made.grasped[::3], made.grasped[-1]]
    for pose in shown:
        gaps = outside(seen(of, pose, made.frame, chosen), made.near, TOUCHES)
        assert gaps.min() > -DEEPEST, LINKS[of.link[chosen[gaps.argmin()]]]
    tips = np.flatnonzero(np.isin(of.link, fingers(side)))
    points = seen(of, made.grasped[-1], made.frame, tips)
    on = outside(points, made.near, TOUCHES) < TOUCHES
    thumb = np.isin(of.link[tips], [INDEX[f"{side}_thumb_proximal"], INDEX[f"{side}_thumb_distal"]])
    assert on[thumb].any()
    assert on[~thumb].any()
    step = 2e-3 * np.eye(3)

    def normals(some: Array) -> Array:
        slope = np.stack(
            [outside(some + s, made.near, 0.01) - outside(some - s, made.near, 0.01) for s in step], axis=1
        )
        return slope / np.linalg.norm(slope, axis=1, keepdims=True)

    assert float((normals(points[on & thumb]) @ normals(points[on & ~thumb]).T).min()) < OPPOSITE


def test_the_hand_stops_open_around_it_and_then_only_goes_on_along_its_own_way(folder: Path) -> None:
    made = pinched(folder, "box", "aiko", "right", 0)
    before, held = (shown[-1].targets[0, :7] for shown in (made.reached, made.grasped))
    np.testing.assert_allclose(np.abs(before[3:] @ held[3:]), 1.0, atol=1e-4)
    went = np.linalg.norm(held[:3] - before[:3])
    assert 0.04 < went < 0.1
    assert abs(float(rotate(made.frame.rotation, np.array([0.0, 1.0, 0.0])) @ (held - before)[:3])) < 0.005
    flexion = [
        2.0 * np.arccos(np.abs(shown[-1].rotations[INDEX["right_index_proximal"], 0]))
        for shown in (made.reached, made.grasped)
    ]
    assert 0.05 < flexion[0] < flexion[1]


def test_a_hand_whose_wrist_does_not_turn_so_far_is_refused_and_told_what_to_do(folder: Path) -> None:
    """What is to be met as its site is turned, and can't be: the palm is not brought into the thing."""
    with pytest.raises(AlgorithmError, match=r"left wrist does not turn so far: .* mm and .* degrees .* use the other"):
        turned_away(folder)


def before_a_mug(
    folder: Path, side: str, turn: float, loop: tuple[float, float] = (0.046, 0.088), at: Array = AT
) -> tuple[Body, Start, Transform]:
    """A human, a mug whose handle points ahead and that is turned then, and a reach for the handle."""
    home = folder / "objectdb" / "mug"
    home.mkdir(parents=True)
    corners = mug(*loop).reshape(-1, 3)
    trimesh.Trimesh(corners, np.arange(len(corners)).reshape(-1, 3), process=False).export(home / "it.stl")
    (home / "object.toml").write_text('name = "mug"\nshape = "it.stl"\nunit = "m"\n')
    kept = Workspace(folder).objects.kept_shape("mug")
    assert kept is not None
    body, frame = Body("ken", facing=0.0), Transform(at, from_axis_angle(UP, np.array(np.radians(turn))))
    ahead = {"handle": SiteRecord((0.049 + loop[0], 0.0, 0.06), (1.0, 0.0, 0.0, 0.0), "z", "power")}
    record = ObjectRecord(
        5, "mug", "mug", tuple(at.tolist()), tuple(frame.rotation.tolist()), ahead, {"diameter": 0.085}, {},
        shape=ShapeRecord(str(kept[0]), kept[1]),
    )  # fmt: skip
    start = Start(
        kind="human", human=body.skeleton.to_record(), pose=PoseRecord.of(body.rotations, body.root), frames=0,
        object=record, site="handle", hand=side,
    )  # fmt: skip
    return body, start, frame


@pytest.mark.parametrize("side", ["right", "left"])
def test_a_handle_behind_its_mug_is_taken_from_beside_it(side: str, tmp_path: Path) -> None:
    body, start, frame = before_a_mug(tmp_path, side, 0.0)
    shown = body.do("reach", start)
    shown += body.do("grasp", replace(start, pose=PoseRecord.of(body.rotations, body.root), frames=30))
    of, near = skin("ken"), mug(0.046, 0.088)
    chosen = np.flatnonzero(np.isin(of.link, [INDEX[f"{side}_hand"], *fingers(side)]))
    for pose in [*shown[20::10], shown[-1]]:
        gaps = outside(seen(of, pose, frame, chosen), near, TOUCHES)
        assert gaps.min() > -DEEPEST, LINKS[of.link[chosen[gaps.argmin()]]]
    on = {LINKS[link].split("_")[1] for link in of.link[chosen[gaps < TOUCHES]].tolist()} - {"hand"}
    assert "thumb" in on
    assert len(on) >= 3, on


@pytest.mark.parametrize(
    ("loop", "turn", "at"), [((0.025, 0.06), -60.0, AT), ((0.046, 0.088), -45.0, np.array([0.42, -0.15, 0.88]))]
)
def test_what_is_reached_for_can_be_grasped(loop: tuple[float, float], turn: float, at: Array, tmp_path: Path) -> None:
    """The open thumb stays out of a narrow loop; where a palm on the bar can't close, the fingers go through it."""
    body, start, frame = before_a_mug(tmp_path, "right", turn, loop, at)
    body.do("reach", start)
    shown = body.do("grasp", replace(start, pose=PoseRecord.of(body.rotations, body.root), frames=30, wish=True))
    of, near = skin("ken"), mug(*loop)
    chosen = np.flatnonzero(np.isin(of.link, [INDEX["right_hand"], *fingers("right")]))
    for pose in [*shown[::10], shown[-1]]:
        gaps = outside(seen(of, pose, frame, chosen), near, LOOSELY)
        assert gaps.min() > -DEEPEST, LINKS[of.link[chosen[gaps.argmin()]]]
    on = {LINKS[link].split("_")[1] for link in of.link[chosen[gaps < LOOSELY]].tolist()} - {"hand"}
    assert "thumb" in on
    assert len(on) >= 3, on


def test_what_could_not_be_grasped_then_is_not_reached_for(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    body, start, _ = before_a_mug(tmp_path, "right", 0.0)
    monkeypatch.setattr(grasping, "closing_depth", lambda *_: np.array([-0.01, 0.0054, 0.0]))
    with pytest.raises(
        AlgorithmError, match="the right hand would be 5 mm in mug as it closes; reach for it from else"
    ):
        body.do("reach", start)


@pytest.mark.parametrize(("side", "turn"), [("right", 90.0), ("left", -90.0)])
def test_a_handle_that_a_hand_can_not_come_to_but_through_its_mug_is_refused(
    side: str, turn: float, tmp_path: Path
) -> None:
    body, start, _ = before_a_mug(tmp_path, side, turn)
    with pytest.raises(AlgorithmError, match=rf"the {side} hand would be \d+ mm in mug; use the other hand"):
        body.do("reach", start)


def turned_away(folder: Path) -> None:
    kept = Workspace(folder).objects.kept_shape("box")
    assert kept is not None
    body = Body("ken", facing=0.0)
    site = SiteRecord((0.0, 0.0, 0.07), (0.5**0.5, 0.5**0.5, 0.0, 0.0))
    record = ObjectRecord(
        5, "box", "box", tuple(AT.tolist()), (1.0, 0.0, 0.0, 0.0), {"sides": site}, {"size": SIZES["box"]}, {}
    )
    body.do(
        "reach",
        Start(
            kind="human", human=body.skeleton.to_record(), pose=PoseRecord.of(body.rotations, body.root), frames=0,
            object=record, site="sides", hand="left",
        ),
    )  # fmt: skip
