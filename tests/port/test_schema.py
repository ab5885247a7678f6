"""The messages on the wire: what they are made of does not change behind a client's back."""

from __future__ import annotations

import msgspec
import pytest

from ahmss.errors import ProtocolError
from ahmss.port import schema

REQUESTS = [
    schema.GetSelf(1), schema.GetObjects("cup", True, 64, 2), schema.GetAffordances("cup", 3),
    schema.Do([schema.Act("cup", "reach", (), (1.0, 2.0), "", 90.0, "left", "a.npz", {"d": 0.1, "e": "x"}, 60, 5)], "",
              4),
    schema.Do(line="do cup reach", request=5), schema.Cancel(7, 6), schema.Stop(7), schema.Await(7, 1.5, 8),
    schema.WaitState("lamp", "light", "==", "on", 2.0, 9), schema.GetEvents(3, 0.5, 10),
]  # fmt: skip
ANSWERS = [
    schema.Refused(1, "no"), schema.Done(2),
    schema.Self(3, "ken", "ken", 1.76, (0.0, 0.0, 0.0), 90.0, (0.0, 0.0, 1.6), (0.0, 1.0, 0.0), {"cup": "right"}, [4],
                "127.0.0.1:7417", 600, 60.0, 1, 2),
    schema.Objects(4, [schema.Thing("cup", "cup", "A cup.", (1.0, 0.0, 0.9), 1.0, -3.0, True, {"n": 1.0, "s": "on"},
                                    "ken", "right", "room")],
                   [schema.Person("aiko", (1.0, 1.0, 0.0), 0.0, 1.4, 45.0)], 64),
    schema.Affordances(5, "cup", [schema.Action("reach", "Reach.", ["hand"], 60, {"d": "float"})],
                       [schema.Unavailable("drink", "ken does not hold it")]),
    schema.Accepted(6, 1, "do cup reach", 2),
    schema.Result(7, 1, "do cup reach", "running", "", 30, [schema.Part("cup reach", 30, 60)], ["a note"]),
    schema.Compared(8, "lamp", True, "on"), schema.Events(9, [schema.Event(1, "done", 1, 60, "do cup reach")], 2, 0),
]  # fmt: skip


@pytest.mark.parametrize("message", REQUESTS, ids=lambda m: type(m).__name__)
def test_a_request_comes_as_it_was_sent(message: schema.Request) -> None:
    assert schema.decode_request(schema.encode(message)) == message


@pytest.mark.parametrize("message", ANSWERS, ids=lambda m: type(m).__name__)
def test_an_answer_comes_as_it_was_sent(message: schema.Reply) -> None:
    assert schema.decode_reply(schema.encode(message)) == message


def test_a_message_is_a_map_with_its_type_and_unknown_fields_are_skipped() -> None:
    plain = msgspec.msgpack.decode(schema.encode(schema.Await(7, 1.5, 8)))
    assert plain == {"type": "await", "number": 7, "seconds": 1.5, "request": 8}
    later = msgspec.msgpack.encode(plain | {"colour": "red"})
    assert schema.decode_request(later) == schema.Await(7, 1.5, 8)


@pytest.mark.parametrize("data", [b"", b"\xff", b"\x80", b"\x92" * 5000, msgspec.msgpack.encode({"type": "explode"})])
def test_bytes_that_are_no_message_are_said_to_be_none(data: bytes) -> None:
    with pytest.raises(ProtocolError, match=r"no request: .* see docs/human-model-port"):
        schema.decode_request(data)
    with pytest.raises(ProtocolError, match="no answer of a main"):
        schema.decode_reply(data)
