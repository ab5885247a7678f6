"""take_up, taken, lay_down and turn_page: a telephone to the ear and back, a manual before the eyes and its pages."""

from __future__ import annotations

from typing import Any

import msgspec
import numpy as np
import pytest

from ahmss.algorithm import HumanPose, ObjectPose, Transform, frames
from ahmss.algorithm.messages import Goal, ObjectRecord, PoseRecord, Start
from ahmss.algorithm.place import WorldObject
from ahmss.body.array import Array
from ahmss.body.fingertip import pad
from ahmss.body.inverse import grips
from ahmss.body.links import INDEX, fingers
from ahmss.body.quaternion import rotate
from ahmss.errors import AlgorithmError
from ahmss.grasping.hand import Hand
from ahmss.motion.smoothness import worst_pop

from .devices import SIDES, at, before, begun, device, mover, posed
from .scene import WORKSPACE, program
from .touching import skin_of

OTHERS = (("ken", "left"), ("aiko", "right"))
CASES = [("ken", "right"), ("aiko", "left"), *(pytest.param(*one, marks=pytest.mark.long) for one in OTHERS)]
CRADLE = np.array([-0.05, 0.0, 0.04])


class Scene:
    """Somebody before a desk with something on it that is taken up."""

    def __init__(
        self, name: str, side: str, kind: str, site: str, to: str, away: float = 0.5, motion: str | None = None,
        over: float | None = None, aside: float = 0.0, turn: float = 0.0, along: float = 0.0,
    ) -> None:  # fmt: skip
        """over: metres that a manual, or a handset's telephone, is over a table's edge; left out: there is neither.

        away, aside, turn: where one stands, metres, and by how many degrees aside one faces. along: metres, to the
        same side, that the table's middle is aside.
        """
        self.base = at(1.0, -0.5, 0.88, 2.1)
        offset = CRADLE if kind == "handset" else np.zeros(3)
        self.frame = Transform(self.base.apply(offset), self.base.rotation)
        self.body, self.side = before(name, self.base, away, aside, turn), side
        self.kind, self.site = kind, site
        self.world: list[ObjectRecord] = []
        if over is not None:
            middle = Transform(self.base.apply(np.array([0.125 - over - 0.5, along, -0.88])), self.base.rotation)
            self.world.append(msgspec.structs.replace(device("table", middle, shaped=True), id=9))
            if kind == "handset":
                self.world.append(msgspec.structs.replace(device("telephone", self.base, shaped=True), id=8))
        self.start = begun(
            self.body, self.named(self.frame), site, {"to": to}, hand=side, hold="take", motion=motion, world=self.world
        )
        self.shown = self.body.do("take_up", self.start)
        self.followed = self.follow(self.start, self.shown)
        self.held = self.followed[-1]

    def named(self, frame: Transform, states: dict[str, Any] | None = None) -> ObjectRecord:
        told = device(self.kind, frame, states, shaped=True)
        return msgspec.structs.replace(told, name=f"telephone/{self.kind}")

    def follow(self, start: Start, shown: list[HumanPose]) -> list[ObjectPose]:
        return list(frames(program("taken"), mover(self.body, start), self.body.rows(shown)))

    def goes_on(self, algorithm: str, parameters: dict[str, Any], hold: str, **given: Any) -> list[HumanPose]:
        """What is done next with it in the hand; the frames of it."""
        self.next = begun(
            self.body, self.named(Transform(self.held.place, self.held.rotation), given.pop("states", None)), self.site,
            parameters, hand=self.side, hold=hold, **given,
        )  # fmt: skip
        return self.body.do(algorithm, self.next)

    def both(self, shown: list[HumanPose]) -> list[ObjectPose]:
        """Where it is in the frames of taking it, and of what was done next."""
        return self.follow(self.start, [*self.shown, *shown])[len(self.shown) :]

    def in_palm(self, shown: list[HumanPose], followed: list[ObjectPose]) -> Array:
        """It in the palm's frame (F, 3)."""
        row = SIDES.index(self.side)
        places: list[Array] = []
        for pose, thing in zip(shown, followed, strict=True):
            palm = Transform.of(grips(self.body.skeleton, pose.rotations, pose.root)[row])
            places.append(palm.inverse().apply(thing.place))
        return np.array(places)


def in_the_telephone(scene: Scene, shown: list[HumanPose], followed: list[ObjectPose]) -> float:
    """Metres by which fingers are in the telephone or in its handset at the most."""
    hand, row, links = Hand.of(scene.body.skeleton, scene.side), SIDES.index(scene.side), list(fingers(scene.side))
    under, bar = (WorldObject.of(device(kind, at(0.0, 0.0, 0.0), shaped=True)) for kind in ("telephone", "handset"))
    assert under.shape is not None
    assert bar.shape is not None
    fields = under.shape.field(CRADLE), bar.shape.field(np.array(bar.sites["bar"].position))
    deepest = -np.inf
    for pose, thing in zip(shown, followed, strict=True):
        palm = Transform.of(grips(scene.body.skeleton, pose.rotations, pose.root)[row])
        for field, frame in zip(fields, (scene.base, Transform(thing.place, thing.rotation)), strict=True):
            seen = frame.inverse().then(palm).row()[None]
            deepest = max(deepest, hand.depth(field, seen, pose.rotations[None, links]))
    return deepest


def in_the_head(scene: Scene, shown: list[HumanPose], followed: list[ObjectPose]) -> float:
    """Metres by which the skin of head and throat is in the handset at the most."""
    skin, bar = skin_of(scene.body.name), WorldObject.of(device("handset", at(0.0, 0.0, 0.0), shaped=True))
    assert bar.shape is not None
    field = bar.shape.field(np.array(bar.sites["bar"].position))
    chosen = np.flatnonzero(np.isin(skin.link, [INDEX["head"], INDEX["spine"]]))
    deepest = -np.inf
    for pose, thing in list(zip(shown, followed, strict=True))[::3]:
        points = skin.posed(pose.rotations, pose.root, chosen)
        seen = Transform(thing.place, thing.rotation).inverse().apply(points)
        near = np.abs(seen).max(axis=-1) < 0.12
        deepest = max(deepest, -float(field.clearance(seen[near]).min(initial=np.inf)))
    return deepest


def head(scene: Scene, pose: HumanPose) -> Transform:
    places, turned = (of[0] for of in posed(scene.body, [pose]))
    return Transform(places[INDEX["head"]], turned[INDEX["head"]])


@pytest.mark.parametrize(("name", "side"), CASES)
def test_a_handset_comes_to_ear_and_mouth_and_goes_back(name: str, side: str) -> None:
    """Fingers "would be 11 mm in" a telephone on its table, as if that were as high as its hook under the handset."""
    scene = Scene(name, side, "handset", "bar", "ear", over=-0.125)
    caught = next(k for k, pose in enumerate(scene.followed) if pose.states.get("taken") == "yes")
    assert np.ptp(scene.in_palm(scene.shown[caught:], scene.followed[caught:]), axis=0).max() < 1e-6
    sign = 1.0 if side == "left" else -1.0
    ends = [Transform(scene.held.place, scene.held.rotation).apply(np.array([0.0, s * 0.074, 0.006])) for s in (1, -1)]
    seen = head(scene, scene.shown[-1]).inverse()
    eye = scene.body.skeleton.eye
    ear, mouth = sorted((seen.apply(end) - eye for end in ends), key=lambda end: -end[2])
    assert 0.05 < sign * ear[1] < 0.11  # at the side of the head, behind the eyes and a little below them
    assert 0.07 < ear[2] < 0.12
    assert -0.06 < ear[0] < 0.0
    assert mouth[0] < -0.04  # before the mouth, and outside of the face
    assert -0.06 < mouth[2] < 0.02
    assert sign * mouth[1] > 0.01
    assert worst_pop(np.array([pose.rotations for pose in scene.shown])).degrees < 2.0
    assert out_of_the_trunk(scene, scene.shown[-1])
    assert in_the_telephone(scene, scene.shown, scene.followed) < 0.002
    shown = scene.goes_on("lay_down", {"rest": "cradle"}, "release", world=scene.world)
    laid = scene.both(shown)
    assert in_the_head(scene, [*scene.shown[caught:], *shown], [*scene.followed[caught:], *laid]) < 0.003  # 20 mm
    assert in_the_telephone(scene, shown, laid) < 0.002  # 13 mm in it, as the hand opened and drew back
    assert [pose.states["taken"] for pose in laid if "taken" in pose.states] == ["no"]
    assert np.linalg.norm(laid[-1].place - scene.frame.place) < 0.003
    assert abs(laid[-1].rotation @ scene.frame.rotation) > 0.9999
    assert np.linalg.norm(shown[-1].targets[SIDES.index(side), :3] - laid[-1].place) > 0.1


def out_of_the_trunk(scene: Scene, pose: HumanPose) -> bool:
    """Whether elbow and forearm are outside of the trunk."""
    places, turned = (of[0] for of in posed(scene.body, [pose]))
    spine = Transform(places[INDEX["spine"]], turned[INDEX["spine"]]).inverse()
    elbow, wrist = (places[INDEX[f"{scene.side}_{link}"]] for link in ("lower_arm", "hand"))
    shoulder = spine.apply(places[INDEX[f"{scene.side}_upper_arm"]])
    for share in (0.0, 0.3, 0.6):
        point = spine.apply(elbow + share * (wrist - elbow))
        if point[0] < shoulder[0] and np.hypot(point[1] / 0.15, point[2] / 0.11) < 1.0:
            return False
    return True


@pytest.mark.parametrize(("name", "side"), CASES)
def test_a_manual_is_held_so_that_it_can_be_read(name: str, side: str) -> None:
    scene = Scene(name, side, "manual", "edge", "eyes")
    page = Transform(scene.held.place, scene.held.rotation)
    eyes = head(scene, scene.shown[-1]).apply(scene.body.skeleton.eye)
    off = eyes - page.place
    assert 0.3 < np.linalg.norm(off) < 0.75
    facing = rotate(page.rotation, np.array([0.0, 0.0, 1.0])) @ off / np.linalg.norm(off)
    assert facing > np.cos(np.radians(40.0))
    assert rotate(page.rotation, np.array([-1.0, 0.0, 0.0]))[2] > 0.2  # what is up in it is up
    assert worst_pop(np.array([pose.rotations for pose in scene.shown])).degrees < 2.0


def leaf_and_pinch(scene: Scene, shown: list[HumanPose]) -> tuple[Array, Array, Array]:
    """How far the leaf is turned (F,), its corner (F, 3), and the middle between thumb and index (F, 3)."""
    book, other = Transform(scene.held.place, scene.held.rotation), SIDES[1 - SIDES.index(scene.side)]
    turn, share = np.zeros(len(shown)), 0.0
    for k, pose in enumerate(shown):
        share = float(pose.states.get("turn", share))
        turn[k] = share
    hinge, corner = np.array([0.0, -0.09, 0.0075]), np.array([0.055, 0.084, 0.007])
    angle = np.radians(358.0) * turn
    off = corner - hinge
    swung = np.stack([np.full(len(turn), off[0]), np.cos(angle) * off[1] - np.sin(angle) * off[2],
                      np.sin(angle) * off[1] + np.cos(angle) * off[2]], axis=-1)  # fmt: skip
    places, turned = posed(scene.body, shown)
    pads: list[Array] = []
    for finger in ("thumb", "index"):
        link = INDEX[f"{other}_{finger}_distal"]
        tip = places[:, link] + rotate(turned[:, link], scene.body.skeleton.tips[link])
        along = rotate(turned[:, link], np.array([1.0, 0.0, 0.0]))
        pads.append(pad(tip, along, float(scene.body.skeleton.radii[link]), along))
    return turn, book.apply(hinge + swung), 0.5 * (pads[0] + pads[1])


def turned(scene: Scene, page: float, **parameters: Any) -> list[HumanPose]:
    """The frames of turning a page, states and all."""
    states = {"page": page, "cover": "open" if page else "closed"}
    start = begun(
        scene.body, scene.named(Transform(scene.held.place, scene.held.rotation), states), scene.site, parameters,
        hand=scene.side, hold="keep",
    )  # fmt: skip
    made = list(frames(program("turn_page"), start))
    shown = scene.body.do("turn_page", start)
    return [
        HumanPose(pose.rotations, pose.root, pose.importance, pose.targets, told.states)
        for pose, told in zip(shown, made, strict=True)
    ]


def test_what_was_given_into_the_hand_goes_with_it_from_the_first_frame() -> None:
    scene = Scene("ken", "left", "manual", "edge", "eyes")
    kept = msgspec.structs.replace(scene.start, hold="keep")
    shown = scene.shown[-80:]  # fingers that have closed already, while it comes before the eyes
    rows = scene.body.rows(shown)
    start = msgspec.structs.replace(kept, kind="object", pose=PoseRecord.of(shown[0].rotations, shown[0].root))
    followed = list(frames(program("taken"), start, rows))
    inner = scene.in_palm(shown, followed)
    assert followed[0].states == {"taken": "yes"}
    assert np.ptp(inner, axis=0).max() < 1e-6
    assert np.ptp([pose.place for pose in followed], axis=0).max() > 0.02


@pytest.mark.parametrize(("name", "side"), [("ken", "left"), ("aiko", "left")])
def test_a_page_goes_with_thumb_and_finger(name: str, side: str) -> None:
    scene = Scene(name, side, "manual", "edge", "eyes")
    shown = turned(scene, 1.0)
    turn, corner, pinch = leaf_and_pinch(scene, shown)
    led = np.flatnonzero((turn > 0.001) & (turn < 0.33))
    assert len(led) > 25
    assert np.linalg.norm(corner[led] - pinch[led], axis=1).max() < 0.01
    pages = [pose.states["page"] for pose in shown if "page" in pose.states]
    assert set(pages) == {2.0}
    assert (np.diff(turn[: int(np.flatnonzero(turn > 0.99)[0])]) >= 0.0).all()
    own = SIDES.index(side)
    held = np.array([grips(scene.body.skeleton, pose.rotations, pose.root)[own, :3] for pose in shown])
    assert np.ptp(held, axis=0).max() < 0.01  # the book is held still


def test_a_page_is_turned_back() -> None:
    scene = Scene("ken", "left", "manual", "edge", "eyes")
    shown = turned(scene, 1.0, back=True)
    told = [pose.states for pose in shown if "turn" in pose.states]
    assert told[0]["page"] == 0.0
    assert told[0]["turn"] > 0.98
    assert told[-1]["turn"] == 0.0


def test_there_is_an_end_to_the_pages() -> None:
    scene = Scene("ken", "left", "manual", "edge", "eyes")
    with pytest.raises(AlgorithmError, match="the last page of telephone/manual is open"):
        turned(scene, 5.0)
    with pytest.raises(AlgorithmError, match="telephone/manual is closed"):
        turned(scene, 0.0, back=True)


def test_a_manual_is_laid_down_where_it_was_said() -> None:
    scene = Scene("aiko", "left", "manual", "edge", "eyes")
    place = scene.frame.apply(np.array([0.05, 0.06, 0.0]))
    shown = scene.goes_on("lay_down", {}, "release", goal=Goal(place=tuple(place.tolist())))
    laid = scene.both(shown)
    assert np.linalg.norm(laid[-1].place - place) < 0.003
    assert rotate(laid[-1].rotation, np.array([0.0, 0.0, 1.0]))[2] > 0.9999


def test_a_manual_is_laid_over_the_edge_of_a_table_and_not_in_its_middle() -> None:
    """Fingers that hold it by its margin were let into the table's top."""
    scene = Scene("aiko", "left", "manual", "edge", "eyes")

    def laid(over: float) -> list[HumanPose]:
        """It is laid so far over the table's edge."""
        middle = Transform(scene.base.apply(np.array([0.125 - over - 0.5, 0.0, -0.88])), scene.base.rotation)
        table = msgspec.structs.replace(device("table", middle), id=9)
        place = scene.base.place
        return scene.goes_on("lay_down", {}, "release", goal=Goal(place=tuple(place.tolist())), world=[table])

    with pytest.raises(
        AlgorithmError, match=r"fingers would be \d+ mm in what telephone/manual is laid on; say a place"
    ):
        laid(-0.05)
    assert np.linalg.norm(scene.both(laid(0.06))[-1].place - scene.base.place) < 0.003


def test_who_does_not_reach_the_place_goes_to_where_they_do_and_lays_it_down() -> None:
    """Behind one, farther than the arm is long, as after a walk round a table."""
    scene = Scene("aiko", "right", "manual", "edge", "eyes")
    place = scene.base.apply(np.array([1.8, 0.5, 0.0]))
    far = Goal(place=tuple(place.tolist()))
    with pytest.raises(AlgorithmError, match="too short for that from here"):
        scene.goes_on("lay_down", {}, "release", goal=far)
    scene = Scene("aiko", "right", "manual", "edge", "eyes")
    motion = str(WORKSPACE.objects.get("manual").affordances["put"].motion)
    shown = scene.goes_on("lay_down", {}, "release", goal=far, motion=motion, busy=["right"])
    laid = scene.both(shown)
    assert np.linalg.norm(laid[-1].place - place) < 0.003
    assert rotate(laid[-1].rotation, np.array([0.0, 0.0, 1.0]))[2] > 0.9999
    away = np.linalg.norm(np.array([pose.root for pose in shown])[:, :2] - place[:2], axis=1)
    assert away[0] > 1.2
    assert away[-1] < 0.7
    held = next(k for k, pose in enumerate(laid) if pose.states.get("taken") == "no")
    assert np.ptp(scene.in_palm(shown[:held], laid[:held]), axis=0).max() < 1e-6


def test_what_is_held_at_another_margin_is_laid_down_as_the_hand_can() -> None:
    """Its lower margin is not towards one then: as what was just received at its side."""
    scene = Scene("aiko", "right", "manual", "edge", "eyes")
    turned = Transform(scene.held.place, scene.held.rotation)
    turned = turned.then(at(0.0, 0.0, 0.0, np.radians(180.0)))
    place = scene.frame.apply(np.array([-0.2, 0.0, 0.0]))
    before = turned.inverse().then(grip(scene, scene.shown[-1]))
    scene.held = ObjectPose(turned.place, turned.rotation)
    shown = scene.goes_on("lay_down", {}, "release", goal=Goal(place=tuple(place.tolist())))
    gone = [grip(scene, pose).then(before.inverse()) for pose in shown]
    laid = min(gone, key=lambda frame: float(np.linalg.norm(frame.place - place)))
    assert np.linalg.norm(laid.place - place) < 0.003
    assert rotate(laid.rotation, np.array([0.0, 0.0, 1.0]))[2] > 0.9999


def grip(scene: Scene, pose: HumanPose) -> Transform:
    return Transform.of(grips(scene.body.skeleton, pose.rotations, pose.root)[SIDES.index(scene.side)])


def test_what_belongs_nowhere_wants_a_place() -> None:
    scene = Scene("ken", "right", "handset", "bar", "ear")
    with pytest.raises(AlgorithmError, match="say a place"):
        scene.goes_on("lay_down", {"rest": "cradle"}, "release")


@pytest.mark.parametrize("side", ["right", "left"])
def test_what_lies_flat_on_a_table_is_taken_over_its_edge_only(side: str) -> None:
    """Fingers went 15 mm through the table top."""
    body, base = before("ken", at(1.0, -0.5, 0.88, 2.1), 0.5), at(1.0, -0.5, 0.88, 2.1)

    def taken(over: float) -> list[HumanPose]:
        """The manual so far over the table's edge."""
        middle = Transform(base.apply(np.array([0.125 - over - 0.5, 0.0, -0.88])), base.rotation)
        table = msgspec.structs.replace(device("table", middle), id=9)
        start = begun(
            body, device("manual", base, shaped=True), "edge", {"to": "eyes"}, hand=side, hold="take", world=[table]
        )
        return body.do("take_up", start)

    with pytest.raises(AlgorithmError, match=r"fingers would be \d+ mm in what manual lies on; lay it so"):
        taken(-0.03)
    assert len(taken(0.06)) > 60


@pytest.mark.parametrize(("name", "side"), [("aiko", "right"), pytest.param("ken", "left", marks=pytest.mark.long)])
def test_fingers_close_and_open_beside_the_table_over_whose_edge_a_manual_lies(name: str, side: str) -> None:
    """An index finger swept 4 mm through the table's edge as it closed, and 10 as it opened."""
    scene = Scene(name, side, "manual", "edge", "eyes", over=0.045)
    table, place = scene.world[0], scene.base.place
    shown = scene.goes_on("lay_down", {}, "release", goal=Goal(place=tuple(place.tolist())), world=[table])
    assert np.linalg.norm(scene.both(shown)[-1].place - place) < 0.003
    top, skin = WorldObject.of(table), skin_of(name)
    assert top.shape is not None
    edge = np.array([0.5, 0.0, 0.87])
    field, chosen = top.shape.field(edge), np.flatnonzero(np.isin(skin.link, list(fingers(side))))
    for pose in [*scene.shown, *shown][::2]:
        seen = top.frame.inverse().apply(skin.posed(pose.rotations, pose.root, chosen)) - edge
        near = np.abs(seen).max(axis=-1) < 0.12
        assert float(field.clearance(edge + seen[near]).min(initial=np.inf)) > -0.001


@pytest.mark.parametrize(
    ("name", "kind", "site", "to"), [("ken", "manual", "edge", "eyes"), ("aiko", "handset", "bar", "ear")]
)
def test_who_does_not_reach_it_steps_there_and_takes_it_up(name: str, kind: str, site: str, to: str) -> None:
    with pytest.raises(AlgorithmError, match="too short for that from here"):
        Scene(name, "right", kind, site, to, away=1.6)
    action = WORKSPACE.objects.get(kind).affordances["take" if kind == "manual" else "pick_up"]
    scene = Scene(name, "right", kind, site, to, away=1.6, motion=str(action.motion))
    away = np.linalg.norm(np.array([pose.root for pose in scene.shown])[:, :2] - scene.frame.place[:2], axis=1)
    assert away[0] > 1.5
    assert away[-1] < 0.7
    assert np.linalg.norm(scene.held.place - head(scene, scene.shown[-1]).place) < 0.6


def test_who_could_take_it_from_here_with_the_hand_askew_only_steps_to_where_it_holds() -> None:
    """From aside the wrist was at its limits, the hand turned by some 30 degrees and its fingers in the handset."""
    base = at(1.0, -0.5, 0.88, 2.1)
    frame, body = Transform(base.apply(CRADLE), base.rotation), before("ken", base, 0.726, -0.325, -33.0)
    motion, begins = str(WORKSPACE.objects.get("handset").affordances["pick_up"].motion), body.root.copy()
    told = device("handset", frame, shaped=True)
    start = begun(body, told, "bar", {"to": "ear"}, hand="left", hold="take", motion=motion)
    shown = body.do("take_up", start)
    assert float(np.linalg.norm(shown[-1].root[:2] - begins[:2])) > 0.15
    near = min(shown, key=lambda one: float(np.linalg.norm(one.targets[1, :3] - frame.place)))
    palm = grips(body.skeleton, near.rotations[None], near.root[None])[0, 1]
    assert np.degrees(2.0 * np.arccos(min(1.0, abs(float(palm[3:] @ near.targets[1, 3:7]))))) < 3.0
