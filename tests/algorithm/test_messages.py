"""The protocol's bytes: version 1 is what the golden files hold, and docs/protocol.md says what messages.py does."""

from __future__ import annotations

import struct
from pathlib import Path

import msgspec
import numpy as np
import pytest

from ahmss.algorithm import messages
from ahmss.algorithm.document import rewrite, tables
from ahmss.algorithm.messages import (
    HEADER,
    Kind,
    Meant,
    Ready,
    Start,
    State,
    decode_meant,
    decode_ready,
    decode_start,
    decode_state,
    encode,
)
from ahmss.algorithm.pose import HumanPose, ObjectPose
from ahmss.errors import ProtocolError

GOLDEN = Path(__file__).parent / "golden"
PAGE = Path(__file__).parents[2] / "docs" / "protocol.md"

ROOT = np.array([0.5, -0.25, 0.875])
ROTATIONS = np.tile([0.5, -0.5, 0.5, -0.5], (43, 1))
GRIPS = np.arange(14.0).reshape(2, 7)
CUP = np.array([1.0, 2.0, 3.0, 1.0, 0.0, 0.0, 0.0])
WAY = np.arange(12.0).reshape(6, 2) / 4.0
MOVED = np.array([[9.0, 4.0, 5.0, 6.0, 0.0, 1.0, 0.0, 0.0]])


def golden(name: str) -> bytes:
    return (GOLDEN / f"{name}.bin").read_bytes()


def numbers(message: bytes) -> tuple[float, ...]:
    """The payload as float64, read without the code under test."""
    return struct.unpack(f"<{(len(message) - 5) // 8}d", message[5:])


def test_the_kinds_keep_their_numbers():
    known = {"START": 1, "FRAME": 2, "STOP": 3, "READY": 16, "POSE": 17, "OBJECT": 18, "STATE": 19, "DONE": 20}
    since = {"REST": 4, "CLOSED": 5, "ERROR": 21, "NOTE": 22, "ARRIVED": 23, "MEANT": 24}
    assert {kind.name: int(kind) for kind in Kind} == known | since


@pytest.mark.parametrize("name", ["start", "start_object"])
def test_start_is_read_and_written_as_ever(name):
    message = golden(name)
    assert HEADER.unpack(message[:5]) == (len(message) - 5, Kind.START)
    start = decode_start(message[5:])
    assert messages.encode_start(start) == message


def test_start_says_what_it_said():
    start = decode_start(golden("start_object")[5:])
    assert (start.kind, start.frames, start.rate, start.seed, start.hand, start.hold) == (
        "object", 90, 60.0, 7, "right", "take",
    )  # fmt: skip
    assert start.object is not None
    assert start.object.sites["handle"].position == (0.045, 0.0, 0.05)
    assert start.object.sites["side"].free_axis == "z"
    assert start.goal.place == (1.0, 2.0, 0.75)
    assert start.world[0].states == {"power": "off"}
    assert start.parameters == {"threshold": 0.05}


def test_fields_that_a_later_version_adds_are_ignored():
    start = msgspec.json.decode(golden("start")[5:])
    start["weather"] = "fine"
    assert decode_start(msgspec.json.encode(start)) == decode_start(golden("start")[5:])


def test_another_version_and_broken_json_are_refused():
    start = msgspec.json.decode(golden("start")[5:])
    with pytest.raises(ProtocolError, match="START is of protocol version 2; this speaks version 1"):
        decode_start(msgspec.json.encode(start | {"version": 2}))
    with pytest.raises(ProtocolError, match=r"START: .*frames"):
        decode_start(msgspec.json.encode(start | {"frames": -1}))
    with pytest.raises(ProtocolError, match="START: "):
        decode_start(b"{")


def test_a_frame_is_these_bytes():
    message = messages.encode_frame(31, ROOT, ROTATIONS, GRIPS)
    assert message == golden("frame")
    assert numbers(message) == (31.0, *ROOT, *ROTATIONS.ravel(), *GRIPS.ravel())


def test_a_frame_for_an_object_algorithm_is_these_bytes():
    message = messages.encode_frame(31, ROOT, ROTATIONS, GRIPS, CUP, MOVED)
    assert message == golden("frame_object")
    assert numbers(message)[190:] == (*CUP, *MOVED.ravel())


def test_the_short_messages_are_these_bytes():
    assert encode(Kind.STOP) == golden("stop") == b"\0\0\0\0\x03"
    assert encode(Kind.DONE) == golden("done") == b"\0\0\0\0\x14"
    assert encode(Kind.ERROR, b"the cup is out of reach") == golden("error")
    assert encode(Kind.NOTE, b"30 frames are too few for 4.2 m; it takes 210") == golden("note")
    assert encode(Kind.READY, msgspec.json.encode(Ready())) == golden("ready")
    assert messages.encode_state(State(7, {"power": "on", "angle": 0.5})) == golden("state")
    assert decode_state(golden("state")[5:]) == State(7, {"power": "on", "angle": 0.5})
    meant = Meant({"level": (0.25, 0.5)}, "it stands at {level}")
    assert messages.encode_meant(meant) == golden("meant")
    assert decode_meant(golden("meant")[5:]) == meant
    assert decode_ready(golden("ready")[5:]) == decode_ready(b"") == Ready(1)


def test_a_pose_is_these_bytes():
    targets = np.zeros((5, 8))
    targets[0] = [1.0, 2.0, 3.0, 0.0, 0.0, 1.0, 0.0, 0.5]
    row = np.zeros(260)
    row[0] = 31
    HumanPose(ROTATIONS, ROOT, np.arange(44.0), targets).pack(row)
    assert encode(Kind.POSE, row.tobytes()) == golden("pose")
    assert numbers(golden("pose")) == (31.0, *ROOT, *ROTATIONS.ravel(), *range(44), *targets.ravel())
    read = HumanPose.of(row)
    assert (read.targets == targets).all()
    assert (read.rotations == ROTATIONS).all()


def test_a_pose_with_a_way_is_these_bytes():
    row = np.zeros(272)
    row[0] = 31
    HumanPose(ROTATIONS, ROOT, np.arange(44.0), way=WAY).pack(row)
    assert encode(Kind.POSE, row.tobytes()) == golden("pose_way")
    assert numbers(golden("pose_way"))[:260] == (31.0, *ROOT, *ROTATIONS.ravel(), *range(44), *[0.0] * 40)
    assert numbers(golden("pose_way"))[260:] == (*WAY.ravel(),)
    assert HumanPose.of(row).way.tolist() == WAY.tolist()


def test_an_objects_pose_is_these_bytes():
    row = np.zeros(8)
    row[0] = 31
    ObjectPose(CUP[:3], CUP[3:]).pack(row)
    assert encode(Kind.OBJECT, row.tobytes()) == golden("object")
    assert numbers(golden("object")) == (31.0, *CUP)


def test_what_is_meant_is_numbers():
    with pytest.raises(ProtocolError, match=r"MEANT: .*\$\.states"):
        decode_meant(b'{"states": {"level": ["much", 1]}, "otherwise": "it is not"}')


def test_a_state_of_a_wrong_type_is_refused_with_its_place():
    with pytest.raises(ProtocolError, match=r"STATE: .*\$\.states"):
        decode_state(b'{"object": 7, "states": [1]}')


def test_a_message_that_is_too_large_is_not_written():
    with pytest.raises(ProtocolError, match="larger than the 16777216 allowed"):
        encode(Kind.STATE, bytes(messages.MAX_PAYLOAD + 1))


def test_the_page_says_what_the_module_does():
    page = PAGE.read_text()
    assert rewrite(page) == page, "run: python -m ahmss.algorithm.document docs/protocol.md"
    for name in tables():
        assert f"<!-- table: {name} -->" in page
    assert {field for field in Start.__struct_fields__ if f"| `{field}` |" not in page} == set()


def write_golden() -> None:
    """Made the files once; a new version of the protocol gets files of its own beside them."""
    from ahmss.algorithm.messages import Goal, ObjectRecord, PoseRecord, SiteRecord

    cup = ObjectRecord(
        7, "room/cup", "cup", (1.0, 2.0, 0.75), (1.0, 0.0, 0.0, 0.0),
        {"handle": SiteRecord((0.045, 0.0, 0.05)), "side": SiteRecord((0.0, 0.0, 0.05), free_axis="z")},
        {"mass": 0.2}, {"full": True},
    )  # fmt: skip
    lamp = ObjectRecord(9, "room/lamp", "lamp", (4.0, 5.0, 6.0), (0.0, 1.0, 0.0, 0.0), states={"power": "off"})
    human = {"name": "golden", "stature": 1.7, "sex": "female"}
    pose = PoseRecord.of(ROTATIONS, ROOT)
    start = Start(kind="human", human=human, pose=pose, frames=60, parameters={"depth": 0.25})
    other = Start(
        kind="object", human=human, pose=pose, frames=90, seed=7, object=cup, site="handle", hand="right", hold="take",
        goal=Goal(place=(1.0, 2.0, 0.75)), motion="lift.npz", parameters={"threshold": 0.05}, world=[lamp],
        directory="algorithms/follow_hand",
    )  # fmt: skip
    targets = np.zeros((5, 8))
    targets[0] = [1.0, 2.0, 3.0, 0.0, 0.0, 1.0, 0.0, 0.5]
    pose_row = np.concatenate([[31.0], ROOT, ROTATIONS.ravel(), np.arange(44.0), targets.ravel()])
    made = {
        "pose": encode(Kind.POSE, pose_row.tobytes()),
        "pose_way": encode(Kind.POSE, np.concatenate([pose_row[:220], np.zeros(40), WAY.ravel()]).tobytes()),
        "object": encode(Kind.OBJECT, np.concatenate([[31.0], CUP]).tobytes()),
        "start": messages.encode_start(start),
        "start_object": messages.encode_start(other),
        "frame": messages.encode_frame(31, ROOT, ROTATIONS, GRIPS),
        "frame_object": messages.encode_frame(31, ROOT, ROTATIONS, GRIPS, CUP, MOVED),
        "stop": encode(Kind.STOP),
        "done": encode(Kind.DONE),
        "error": encode(Kind.ERROR, b"the cup is out of reach"),
        "note": encode(Kind.NOTE, b"30 frames are too few for 4.2 m; it takes 210"),
        "ready": encode(Kind.READY, msgspec.json.encode(Ready())),
        "state": messages.encode_state(State(7, {"power": "on", "angle": 0.5})),
        "meant": messages.encode_meant(Meant({"level": (0.25, 0.5)}, "it stands at {level}")),
    }
    for name, message in made.items():
        path = GOLDEN / f"{name}.bin"
        if not path.exists():
            path.write_bytes(message)


if __name__ == "__main__":
    write_golden()
