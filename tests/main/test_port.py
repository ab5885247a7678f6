"""The port of a main: what a human model asks and is answered, and what clients of all sorts can't do to the frames."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
import pytest
import zmq

from ahmss.client import Client, act
from ahmss.errors import ActionFailed, NoAnswer, PortRefused, WorldError
from ahmss.main.command import Add
from ahmss.main.process import MainProcess, Setup
from ahmss.port import schema
from ahmss.world import keys
from ahmss.world.address import Address
from ahmss.world.client import WorldClient
from ahmss.world.process import ServerProcess
from tests.main.conftest import make_workspace
from tests.main.ground import steps

LOOPBACK = Address("127.0.0.1", 0)


@pytest.fixture(scope="module")
def main(tmp_path_factory: pytest.TempPathFactory, pool: None) -> Iterator[MainProcess]:
    """A main in real time with a port; its frames are made by the test, or by the fixture `ken`."""
    workspace = make_workspace(tmp_path_factory.mktemp("port") / "workspace")
    with ServerProcess() as server:
        made = MainProcess(
            Setup("ken", "ken", server=server.address, workspace=workspace, port=LOOPBACK), lambda _: None
        )
        made.play(steps("add box as b at 0.6 0 1.5", "add box as far at 3 0.3 0.5", "add box as behind at -2 0 1.5"))
        yield made
        made.close()


@pytest.fixture
def ken(main: MainProcess) -> Iterator[Client]:
    """A client, while the frames run."""
    assert main.port is not None
    over = threading.Event()
    frames = threading.Thread(target=main.run, args=(over.is_set,))
    frames.start()
    with Client(str(main.port.address), timeout=20.0) as client:
        yield client
        client.stop()
    over.set()
    frames.join()


@pytest.fixture
def raw(main: MainProcess) -> Iterator[Callable[..., zmq.Socket[bytes]]]:
    """Sockets that say what they like."""
    context = zmq.Context()
    sockets: list[zmq.Socket[bytes]] = []

    def connect(kind: int = zmq.DEALER, to: MainProcess | None = None, **options: int) -> zmq.Socket[bytes]:
        port = (to or main).port
        assert port is not None
        sockets.append(context.socket(kind))
        for option, value in {"LINGER": 0, "RCVTIMEO": 20_000, **options}.items():
            sockets[-1].setsockopt(getattr(zmq, option), value)
        sockets[-1].connect(port.address.endpoint())
        return sockets[-1]

    yield connect
    for socket in sockets:
        socket.close(0)
    context.term()


# What a human model asks


def test_it_is_told_who_it_is_and_what_is_here(ken: Client) -> None:
    me = ken.me()
    assert (me.human, me.body, me.holds, me.doing) == ("ken", "ken", {}, [])
    assert me.place == pytest.approx((0.0, 0.0, 0.0), abs=0.05)
    assert me.gaze == pytest.approx((0.966, 0.0, -0.259), abs=0.05)
    here = {thing.name: thing for thing in ken.objects()}
    assert set(here) == {"b", "far", "behind"}
    box = here["b"]
    assert (box.kind, box.sentence, box.states) == ("box", "A box to be acted on.", {"lid": "shut"})
    assert (box.distance, box.direction_deg) == (pytest.approx(0.6, abs=0.05), pytest.approx(0.0, abs=3.0))
    assert here["far"].direction_deg == pytest.approx(np.degrees(np.arctan2(0.3, 3.0)), abs=3.0)
    assert abs(here["behind"].direction_deg) > 175.0
    assert {thing.name for thing in ken.seen()} == {"b", "far"}
    assert ken.state("b") == {"lid": "shut"}


def test_what_is_afforded_is_what_the_dialogue_lists_and_the_rest_says_why_not(ken: Client) -> None:
    told = ken.afforded("b")
    now = {action.name: action for action in told.now}
    assert {"wave", "open", "take", "step"} <= set(now)
    assert now["step"].asks == ["goal_position"]
    assert now["wave"].frames == 20
    assert now["wave"].parameters == {
        "link": "str (usually right_upper_arm)", "angle": "float (usually 0.6)",
    }  # fmt: skip
    later = {action.name: action.reason for action in told.later}
    assert later["drop"] == "b drop: ken does not hold it"
    assert "a reach of 3 m" in later["reach_high"]


def test_a_line_is_accepted_goes_on_and_is_done(ken: Client, main: MainProcess) -> None:
    _, since = ken.events()
    handle = ken.do("b", "wave", frames=30)
    assert handle.line == "do b wave frames 30"
    assert handle.wait(20.0).status == "done"
    assert handle.result is not None
    assert handle.result.frames >= 30
    events, following = ken.events(since)
    assert [(event.kind, event.number) for event in events] == [
        (kind, handle.number) for kind in ("accepted", "began", "done")
    ]
    assert events[-1].frame - events[1].frame >= 30
    assert ken.events(following) == ([], following)


def test_progress_says_how_far_each_of_two_fused_motions_is(ken: Client) -> None:
    handle = ken.together(act("b", "wave", frames=2000), act("b", "bow", frames=2000, after=1000))
    while not (parts := handle.progress.parts):
        pass
    assert [(part.title, part.of) for part in parts] == [("b wave", 2000), ("b bow", 2000)]
    assert parts[0].frame > parts[1].frame == 0
    assert ken.me().doing == [handle.number]
    assert handle.cancel().status == "cancelled"
    with pytest.raises(ActionFailed, match="cancelled"):
        handle.wait()


def test_lines_wait_for_those_before_and_each_can_be_given_up_alone(ken: Client, main: MainProcess) -> None:
    first, second, third = (ken.do("b", action, frames=4000) for action in ("wave", "bow", "wave"))
    assert second.progress.status == third.progress.status == "waiting"
    assert second.cancel().status == "cancelled"
    assert first.progress.status == "running"
    assert first.cancel().status == "cancelled"
    while third.progress.status == "waiting":
        pass
    assert third.progress.status == "running"
    ken.stop()
    assert third.wait(20.0, check=False).status == "cancelled"
    assert main.control.progress == []


def test_what_fails_says_why_and_what_comes_after_goes_on(ken: Client, main: MainProcess) -> None:
    before = ken.do("b", "wave", frames=60)
    failing, after = ken.do("b", "drop"), ken.do("b", "wave", frames=5)
    assert before.wait(20.0).status == "done"
    with pytest.raises(ActionFailed, match="do b drop: b drop: ken does not hold it"):
        failing.wait(20.0)
    assert after.wait(20.0).status == "done"


@pytest.mark.parametrize(
    ("words", "says"),
    [
        ({"object": "c", "action": "wave"}, "there are: b, far, behind"),
        ({"object": "behin", "action": "wave"}, "did you mean behind"),
        ({"object": "box", "action": "wave"}, 'called "box"; of that kind there are: b, far, behind'),
        ({"object": "b", "action": "fly"}, "it affords: wave, bow"),
        ({"object": "b", "action": "drop"}, "ken does not hold it; it affords now: wave, bow"),
        ({"object": "b", "action": "step"}, "add `to X Y Z`"),
        ({"object": "b", "action": "wave", "frames": 0}, "a whole number from 1 to 1000000; the line was: do b wave"),
        ({"object": "b", "action": "wave", "parameters": {"speed": 2.0}}, "angle, link; every action: patience"),
        ({"object": "b", "action": "wave", "parameters": {"angle": "wide"}}, "parameter angle: 'wide' is no"),
        ({"object": (9.0, 9.0), "action": "wave"}, 'no object within 0.5 m of 9 9 affords "wave"'),
    ],
)
def test_a_refusal_says_what_would_have_been_right(ken: Client, words: dict[str, object], says: str) -> None:
    with pytest.raises(PortRefused) as caught:
        ken.do(**words)  # type: ignore[arg-type]
    assert says in str(caught.value)


def test_only_lines_that_move_this_human_are_taken(ken: Client) -> None:
    for line, says in (
        ("remove b", "begin with do"), ("aiko: do b wave", "moves ken, not aiko"), ("do b", "expected: an action"),
    ):  # fmt: skip
        with pytest.raises(PortRefused, match=says):
            ken.do_line(line)
    assert ken.do_line("ken: do b wave frames 3").wait(20.0).status == "done"


def test_what_another_has_is_refused_at_once_but_to_who_has_patience(ken: Client, main: MainProcess) -> None:
    server = str(main.communication.client.address)
    aiko = MainProcess(
        Setup("aiko", "aiko", server=server, workspace=main.workspace.root, place=(0.0, 1.0)), lambda _: None
    )
    try:
        aiko.play(steps("do b take frames 20"))
        for words in ("", " patience=0"):
            with pytest.raises(PortRefused, match="b take: aiko holds it; wait until it is let go"):
                ken.do_line(f"do b take{words} frames 20")
        taking = ken.do_line("do b take patience=30 frames 20")
        while not taking.progress.notes:
            aiko.frame()
        assert taking.progress.notes == ["b take: waits for aiko, who has b"]
        aiko.play(steps("do b drop frames 20"))
        taking.wait(timeout=30.0)
        assert ken.object("b").holder == "ken"
        ken.do_line("do b drop frames 20").wait(timeout=30.0)
    finally:
        aiko.close()


def test_a_state_is_waited_for_and_one_that_never_comes_is_refused(ken: Client, main: MainProcess) -> None:
    assert ken.wait_until("b", "lid", "==", "shut") == "shut"
    with pytest.raises(TimeoutError, match=r"b lid is shut after 0\.1 s, not == open"):
        ken.wait_until("b", "lid", "==", "open", timeout=0.1)
    for arguments, says in (
        (("b", "lid", "==", "ajar"), 'never "ajar"; allowed: .*open'), (("b", "lit", "==", "open"), "it has: lid"),
        (("b", "lid", "=", "open"), "use one of: == !="), (("x", "lid", "==", "open"), "there are: b"),
    ):  # fmt: skip
        with pytest.raises(PortRefused, match=says):
            ken.wait_until(*arguments)
    assert ken.wait_until("b", "lid", "!=", 3.0) == "shut"
    with pytest.raises(PortRefused, match=r'never "3\.0"'):
        ken.wait_until("b", "lid", "==", 3.0)
    later = threading.Timer(0.3, lambda: main.communication.set_state("b", "lid", "open"))
    later.start()
    assert ken.wait_until("b", "lid", "!=", "shut", timeout=20.0) == "open"
    assert {action.name for action in ken.afforded("b").later} >= {"open"}
    main.communication.set_state("b", "lid", "shut")
    assert ken.wait_until("b", "lid", "==", "shut", timeout=20.0) == "shut"


def test_no_name_is_no_object_and_a_request_too_long_is_not_sent(ken: Client) -> None:
    with pytest.raises(PortRefused, match=r'no object ""'):
        ken.state("")
    with pytest.raises(PortRefused, match="is too long; allowed are 65536"):
        ken.do_line("do " + "x" * 70_000)
    assert ken.me().human == "ken"


def test_a_number_that_is_none_and_too_many_lines_are_refused(ken: Client) -> None:
    with pytest.raises(PortRefused, match="no line has number 99999: none was accepted under it; the last are: "):
        ken.result(99999)
    with pytest.raises(PortRefused, match="waits 0 to 60 s"):
        ken.result(1, 1e9)
    for _ in range(33):
        ken.do("b", "wave", frames=5000)
    with pytest.raises(PortRefused, match="32 lines wait already"):
        ken.do("b", "wave", frames=5000)
    assert len(ken.me().doing) == 33


def test_who_asks_before_the_scene_is_set_waits_for_it(
    join: Callable[..., MainProcess], server: Callable[..., ServerProcess], raw: Callable[..., zmq.Socket[bytes]]
) -> None:
    early = join(server(), port=LOOPBACK)
    assert early.port is not None
    early.agenda.set_the_scene([Add("box", "b", (0.6, 0.0, 1.5)), Add("nothing")])
    socket = raw(to=early)
    for request in (schema.GetSelf(1), schema.GetObjects("b", request=2), schema.Do(line="do b wave", request=3)):
        socket.send(schema.encode(request))
    told = {answer.request: type(answer) for answer in (_answer(early, socket) for _ in range(3))}
    assert told == {1: schema.Self, 2: schema.Objects, 3: schema.Accepted}
    assert len(early.report.messages) == 1  # of the kind that is none; what is there is there all the same


# Several clients, and such as do harm


def test_one_client_waits_while_another_asks_and_gives_its_line_up(ken: Client, main: MainProcess) -> None:
    assert main.port is not None
    with Client(str(main.port.address), timeout=20.0) as other:
        handle = ken.do("b", "wave", frames=5000)
        waited: list[str] = []
        waiting = threading.Thread(target=lambda: waited.append(handle.wait(20.0, check=False).status))
        waiting.start()
        assert other.me().doing == [handle.number]
        assert other.afforded("b").now
        assert other.cancel(handle.number).status == "cancelled"
        waiting.join()
        assert waited == ["cancelled"]


def test_an_answer_to_one_who_is_gone_is_lost_and_nothing_else(
    main: MainProcess, raw: Callable[..., zmq.Socket[bytes]]
) -> None:
    port, gone = main.port, raw()
    assert port is not None
    lost, messages = port.lost, len(main.report.messages)
    taken = port.taken
    for number in range(1, 16):
        gone.send(schema.encode(schema.GetEvents(10**6, 0.5 * number, number)))
    while port.taken < taken + 15:
        port.serve()
    gone.close(0)
    for _ in range(500):  # the first answers may still find the connection
        main.frame()
        time.sleep(0.001)
    assert port.lost > lost
    assert len(main.report.messages) == messages


@pytest.mark.parametrize("garbage", [b"", b"\xff" * 100, b"do b wave", schema.encode(schema.Done(1))])
def test_bytes_that_are_no_request_are_answered_with_one_sentence(
    main: MainProcess, raw: Callable[..., zmq.Socket[bytes]], garbage: bytes
) -> None:
    socket = raw()
    socket.send(garbage)
    answer = _answer(main, socket)
    assert isinstance(answer, schema.Refused)
    assert "no request" in answer.reason
    socket.send(schema.encode(schema.GetSelf(7)))
    assert isinstance(_answer(main, socket), schema.Self)


def test_a_request_in_many_parts_and_one_too_long_harm_nobody_else(
    main: MainProcess, raw: Callable[..., zmq.Socket[bytes]]
) -> None:
    parts, long, good = raw(), raw(), raw()
    parts.send_multipart([b"a", b"b", b"c"])
    assert isinstance(_answer(main, parts), schema.Refused)
    long.send(bytes(2 * schema.LARGEST))
    good.send(schema.encode(schema.GetSelf(1)))
    assert isinstance(_answer(main, good), schema.Self)


def test_a_socket_of_kind_req_is_answered(main: MainProcess, raw: Callable[..., zmq.Socket[bytes]]) -> None:
    socket = raw(zmq.REQ)
    socket.send(schema.encode(schema.GetSelf(3)))
    answer = _answer(main, socket)
    assert isinstance(answer, schema.Self)
    assert answer.request == 3


def test_a_flood_takes_a_bounded_share_of_each_frame_and_holds_up_neither_frames_nor_others(
    main: MainProcess, raw: Callable[..., zmq.Socket[bytes]]
) -> None:
    port, flood, other = main.port, raw(SNDHWM=5000), raw()
    assert port is not None
    sent = 2000
    for number in range(sent):
        flood.send(schema.encode(schema.GetObjects(request=number)))
    with WorldClient(main.communication.client.address) as world:
        shown, frames, start = world.stats().frames, main.report.frames, port.taken
        while port.taken == start:
            main.frame()
        other.send(schema.encode(schema.GetSelf(1)))
        answered = 0
        while port.taken < start + sent + 1:
            taken = port.taken
            main.frame()
            assert port.taken - taken <= 16
            if not answered and other.poll(0):
                answered = main.report.frames
        made = main.report.frames - frames
        assert made >= sent // 16
        assert 0 < answered < main.report.frames - 50  # long before the flood was dealt with
        main.communication.client.hello()  # all frames before it are in the world then
        assert world.stats().frames - shown == made


def test_one_that_asks_too_much_at_once_is_told_so(main: MainProcess, raw: Callable[..., zmq.Socket[bytes]]) -> None:
    greedy, other = raw(), raw()
    for number in range(1, 18):
        greedy.send(schema.encode(schema.GetEvents(10**6, 2.0, number)))
    answer = _answer(main, greedy)
    assert isinstance(answer, schema.Refused)
    assert (answer.request, answer.reason) == (17, "too many questions at once; wait for the answers to those before")
    other.send(schema.encode(schema.GetSelf(1)))
    assert isinstance(_answer(main, other), schema.Self)


def test_one_that_does_not_read_loses_answers_and_stops_nobody(
    main: MainProcess, raw: Callable[..., zmq.Socket[bytes]]
) -> None:
    port = main.port
    assert port is not None
    slow = raw(RCVHWM=1, RCVBUF=4096, SNDHWM=5000)
    lost, name = port.lost, "x" * 60_000  # which the answer repeats
    for _ in range(2000):
        if port.lost > lost:
            break
        slow.send(schema.encode(schema.GetAffordances(name, 1)))
        port.serve()
    assert port.lost > lost
    other = raw()
    other.send(schema.encode(schema.GetSelf(1)))
    assert isinstance(_answer(main, other), schema.Self)


# Who is let in


def test_a_port_for_other_machines_needs_keys_and_lets_in_who_has_them(
    join: Callable[..., MainProcess], server: Callable[..., ServerProcess], tmp_path: Path
) -> None:
    address = server().address
    with pytest.raises(WorldError, match=r"needs keys; .*--port-keys"):
        join(address, port=Address("0.0.0.0", 0))
    keys.make(tmp_path / "ours")
    keys.make(tmp_path / "theirs")
    (tmp_path / "theirs" / "server.pub").write_bytes((tmp_path / "ours" / "server.pub").read_bytes())
    main = join(address, port=Address("0.0.0.0", 0), port_keys=tmp_path / "ours")
    assert main.port is not None
    here = f"127.0.0.1:{main.port.address.port}"
    over = threading.Event()
    frames = threading.Thread(target=main.run, args=(over.is_set,))
    frames.start()
    try:
        with Client(here, keys=tmp_path / "ours", timeout=20.0) as client:
            assert client.me().human == "ken"
        for allowed in ({"keys": tmp_path / "theirs"}, {}):
            with (
                Client(here, timeout=0.5, **allowed) as stranger,
                pytest.raises(NoAnswer, match="check the address and"),
            ):
                stranger.me()
    finally:
        over.set()
        frames.join()


def test_a_port_that_is_taken_is_said_to_be_and_the_human_leaves(
    main: MainProcess, join: Callable[..., MainProcess], server: Callable[..., ServerProcess]
) -> None:
    assert main.port is not None
    address = server().address
    with pytest.raises(WorldError, match="stop what is there or name another port"):
        join(address, port=main.port.address)
    with WorldClient(address) as world:
        assert world.refresh().humans == {}


def _answer(main: MainProcess, socket: zmq.Socket[bytes]) -> schema.Reply:
    """The next answer that a socket gets; the test makes the frames."""
    for _ in range(5000):
        main.frame()
        if socket.poll(1):
            return schema.decode_reply(socket.recv_multipart()[-1])
    raise AssertionError("nobody answered")
