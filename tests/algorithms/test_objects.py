"""door and follow_hand: what the hand does to things."""

from __future__ import annotations

import numpy as np
import pytest

from ahmss.algorithm import HumanPose, ObjectPose, Transform, frames
from ahmss.algorithm.messages import Start
from ahmss.algorithm.performance import Performance
from ahmss.body.links import INDEX
from ahmss.body.quaternion import conjugate, from_axis_angle, multiply, rotate, to_rotation_vector

from .scene import CUP, DOOR, Body, frame_of, program

UP = np.array([0.0, 0.0, 1.0])


def angles(poses: list[ObjectPose]) -> np.ndarray:
    """Degrees from the closed door, at each frame."""
    closed = frame_of(DOOR).rotation
    return np.degrees([to_rotation_vector(multiply(conjugate(closed), pose.rotation))[2] for pose in poses])


def at_door() -> Body:
    """Who stands where the captured motions of the door begin."""
    return Body(x=-0.47)


def opened(body: Body) -> list[ObjectPose]:
    start = body.start(DOOR, "play_open")
    shown = body.do("playback", start)
    return list(frames(program("door"), body.start(DOOR, "play_open", kind="object"), body.rows(shown)))


def test_the_door_follows_the_hand_and_stays_where_it_is_left() -> None:
    angle = angles(opened(at_door()))
    assert angle[:70] == pytest.approx(0.0)  # the hand is on its way
    assert 28.0 < angle[-1] < 31.0
    assert angle[-60:] == pytest.approx(angle[-1])
    assert np.abs(np.diff(angle, n=2)).max() < 0.1


def test_the_door_turns_about_its_hinge_only() -> None:
    for pose in opened(at_door()):
        np.testing.assert_allclose(pose.place, frame_of(DOOR).place)
        turned = to_rotation_vector(multiply(conjugate(frame_of(DOOR).rotation), pose.rotation))
        np.testing.assert_allclose(turned[:2], 0.0, atol=1e-9)


def test_the_door_tells_its_angle_only_while_it_changes() -> None:
    told = [dict(pose.states) for pose in opened(at_door())]
    assert not any(told[:70])
    assert not any(told[-60:])
    heard = [states["angle"] for states in told if states]
    assert heard == sorted(heard)
    assert heard[-1] == pytest.approx(np.radians(30.0), abs=0.03)


def test_an_open_hand_does_not_move_the_door() -> None:
    body = at_door()
    shown = body.do("playback", body.start(DOOR, "play_open"))
    for pose in shown:
        pose.rotations[INDEX["right_thumb_proximal"] : INDEX["right_little_distal"] + 1] = [1.0, 0.0, 0.0, 0.0]
    poses = list(frames(program("door"), body.start(DOOR, "play_open", kind="object"), body.rows(shown)))
    assert angles(poses) == pytest.approx(0.0)


def test_the_door_stops_when_the_hand_leaves_its_arc() -> None:
    body = at_door()
    rows = body.rows(body.do("playback", body.start(DOOR, "play_open")))
    for row in rows[110:]:
        row[176 + 2] += 0.2  # the hand goes up
    poses = list(frames(program("door"), body.start(DOOR, "play_open", kind="object"), rows))
    angle = angles(poses)
    assert 1.0 < angle[109] < 29.0
    assert angle[111:] == pytest.approx(angle[110])


def test_a_palm_that_turns_on_the_knob_does_not_turn_the_door() -> None:
    body = at_door()
    shown = body.do("playback", body.start(DOOR, "play_open"))[:110]
    leaf = frame_of(DOOR).then(Transform(np.zeros(3), from_axis_angle(UP, np.radians(turned_by(shown)))))
    knob, along = leaf.apply(np.array([0.68, -0.075, 1.02])), rotate(leaf.rotation, np.array([1.0, 0.0, 0.0]))
    for degrees in np.linspace(0.0, 25.0, 20):
        turn = from_axis_angle(along, np.radians(degrees))
        rotations = shown[109].rotations.copy()
        rotations[0] = multiply(turn, rotations[0])
        root = knob + rotate(turn, shown[109].root - knob)
        shown.append(HumanPose(rotations, root, shown[109].importance, shown[109].targets))
    angle = angles(list(frames(program("door"), body.start(DOOR, "play_open", kind="object"), body.rows(shown))))
    assert angle[109] > 1.0
    assert angle[110:] == pytest.approx(angle[109], abs=0.02)


def turned_by(shown: list[HumanPose]) -> float:
    """Degrees that the door is open after frames of who opens it."""
    body = at_door()
    return float(
        angles(list(frames(program("door"), body.start(DOOR, "play_open", kind="object"), body.rows(shown))))[-1]
    )


def test_the_door_is_closed_from_where_it_stands() -> None:
    body = at_door()
    leaf = opened(body)[-1]
    start = body.start(DOOR, "play_close", frame=Transform(leaf.place, leaf.rotation))
    shown = body.do("playback", start)
    at = angles([leaf])[0]
    stood = Transform(leaf.place, leaf.rotation)
    start = body.start(DOOR, "play_close", kind="object", frame=stood, states={"angle": float(np.radians(at))})
    angle = angles(list(frames(program("door"), start, body.rows(shown))))
    assert angle[0] == pytest.approx(at, abs=1e-6)
    assert abs(angle[-1]) < 0.5


def grasped(body: Body) -> list[ObjectPose]:
    """The cup, while the hand closes and then goes up by 2 cm a frame and turns."""
    body.do("reach", body.start(CUP, "reach"))
    rows = body.rows(body.do("grasp", body.start(CUP, "grasp")))
    for i in range(1, 21):
        row = rows[29].copy()
        row[0] = 30 + i
        row[178] += 0.02 * i
        row[179:183] = multiply(from_axis_angle(UP, 0.05 * i), row[179:183])
        rows.append(row)
    start = body.start(CUP, "grasp", kind="object", frames=30)
    return frames_beyond(start, rows)


def frames_beyond(start: Start, rows: list[np.ndarray]) -> list[ObjectPose]:
    """As `frames`, which ends with N; what was caught goes on."""
    performance = Performance(program("follow_hand"), start)
    shown = []
    for row in rows:
        held = performance.task.object
        performance.task.progress.closed = row[0] >= start.frames
        assert performance.step(np.concatenate([row, held.place, held.rotation]))
        pose = ObjectPose(performance.row[1:4].copy(), performance.row[4:8].copy())
        held.place[:], held.rotation[:] = pose.place, pose.rotation
        shown.append(pose)
    return shown


def test_the_cup_is_caught_without_a_jump_and_follows() -> None:
    poses = grasped(Body())
    places = np.array([pose.place for pose in poses])
    np.testing.assert_allclose(places[:30], np.tile(frame_of(CUP).place, (30, 1)), atol=1e-9)
    assert places[-1, 2] - places[29, 2] == pytest.approx(0.4, abs=1e-6)
    steps = np.linalg.norm(np.diff(places, axis=0), axis=1)
    assert steps[30:].max() < 0.03


def test_a_cup_that_is_too_far_stays() -> None:
    body = Body()
    rows = [body.row(k) for k in range(1, 41)]
    start = body.start(CUP, "grasp", kind="object", frames=30)
    for pose in frames_beyond(start, rows):
        np.testing.assert_allclose(pose.place, frame_of(CUP).place)
