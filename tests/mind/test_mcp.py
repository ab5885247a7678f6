"""A language model's way: list, ask, act, be refused, read why, and do what is right."""

from __future__ import annotations

import io
import re
import subprocess
import sys
from typing import Any

import numpy as np
import pytest
from ahmss_viewer.graphics import find_headless
from PIL import Image

from ahmss import cli
from ahmss.errors import NoAnswer
from ahmss.mind.tools import Mind, make_server
from tests.mind.conftest import Collaborator, collaborate


def test_every_tool_tells_what_it_does_and_what_each_argument_means(at_the_table: Collaborator) -> None:
    tools = at_the_table.tools
    assert list(tools) == ["where_am_i", "list_objects", "what_can_i_do", "act", "do", "wait", "stop", "look"]
    for tool in tools.values():
        assert len(tool.description) > 60
        for argument in tool.input_schema["properties"]:
            assert f"{argument}:" in tool.description
        assert tool.input_schema["additionalProperties"] is False
        assert f'{tool.name}: no argument "near"' in at_the_table.wrong(tool.name, near="cup")
    assert '"seen"' in (said := at_the_table.wrong("list_objects", seen=True))
    assert said.endswith('did you mean "seen_only"?; allowed: seen_only')
    said = at_the_table.wrong("acts", object="cup")
    assert said.startswith('no tool "acts", did you mean "act"?; allowed: ')
    assert all(name in said.partition("allowed: ")[2] for name in tools)
    assert all("patience" in tools[name].description for name in ("what_can_i_do", "act"))
    assert "You are ken, 1.76 m tall. You stand at x" in at_the_table.instructions
    assert all(name in at_the_table.instructions for name in ("list_objects", "what_can_i_do", "act"))


def test_a_plan_is_followed_from_refusal_to_refusal_until_the_cup_is_lifted(at_the_table: Collaborator) -> None:
    mind = at_the_table
    assert re.search(r"^room/cup: A cup .*\[0\.4 m ahead; at 0\.42 -0\.15 0\.88\]$", mind.right("list_objects"), re.M)
    # A wrong name: the right one is in the sentence.
    meant = re.search(r"did you mean (\w+)\?", mind.wrong("act", object="cupp", action="lift"))
    assert meant is not None
    cup = meant[1]
    # A wrong action: those that there are.
    offered = re.search(r"it affords: (.+)", mind.wrong("act", object=cup, action="pick_up"))
    assert offered is not None
    assert offered[1].split(", ")[:3] == ["reach", "grasp", "lift"]
    # The wrong order: what can be done now, first of all.
    now = re.search(r"ken does not hold it; it affords now: (.+)", mind.wrong("act", object=cup, action="lift"))
    assert now is not None
    first, second, *others = now[1].split(", ")
    assert (first, second, others) == ("reach", "grasp", ["point"])  # as everything, it may be pointed at
    assert "- lift: ken does not hold it" in mind.right("what_can_i_do", object=cup)
    # Values out of range, each with the range.
    ranged = re.search(
        r"allowed: (\S+) to (\S+) m", mind.wrong("act", object=cup, action=second, parameters={"diameter": -3})
    )
    assert ranged is not None
    low, high = float(ranged[1]), float(ranged[2])
    assert "a whole number from 1" in mind.wrong("act", object=cup, action=second, frames=0)
    assert "`left` or `right`" in mind.wrong("act", object=cup, action=second, hand="both")
    assert 'frames "many" is not a whole number; give a whole number: how long it takes, 60 to' in mind.wrong(
        "act", object=cup, action=second, frames="many"
    )
    told = mind.right("act", object=cup, action=second, parameters={"diameter": 0.5 * (low + high)}, frames=30)
    assert "it affords now: lift, drink, carry, put, release" in told
    assert "done after" in mind.right("act", object=cup, action="lift")
    # A goal that is none: what to say instead.
    assert "has no top that things are put on; say a place" in mind.wrong("act", object=cup, action="put", to="chair")
    assert "done after" in mind.right("act", object=cup, action="put", to="table")
    assert "You hold room/cup in the " in mind.right("where_am_i")


@pytest.mark.parametrize(
    ("tool", "given", "said"),
    [
        ("act", {"object": "cup", "action": "look", "facing_deg": "north"},
         'act: facing_deg "north" is not a number; give a number: which way to face at the goal, degrees: 0 is +x'),
        ("act", {"object": "cup", "action": "put", "to": [0.2, -0.9]},
         'act: to [0.2, -0.9] is not a text; give a text: the goal: another object\'s name, or "x y" or "x y z"'),
        ("act", {"object": "cup", "action": "put", "parameters": {"diameter": [1]}},
         'act: parameters {"diameter": [1]} is not names with their values'),
        ("act", {"object": "cup"}, 'act: the argument "action" is missing; it is a text: one that what_can_i_do lists'),
        ("look", {"names": "perhaps"}, 'look: names "perhaps" is not true or false; give true or false: whether names'),
        ("wait", {"number": "first"}, 'wait: number "first" is not a whole number; give a whole number: of a line'),
        ("wait", {"seconds": "long"}, 'wait: seconds "long" is not a number; give a number: how long at most, 0'),
        ("do", {"line": 3}, "do: line 3 is not a text; give a text: begins with do"),
        ("what_can_i_do", {}, 'what_can_i_do: the argument "object" is missing; it is a text: its name as'),
    ],
)  # fmt: skip
def test_what_is_of_a_wrong_type_is_told_in_one_sentence_with_what_to_give(
    at_the_table: Collaborator, tool: str, given: dict[str, Any], said: str
) -> None:
    told = at_the_table.wrong(tool, **given)
    assert told.startswith(said)
    assert "\n" not in told
    assert "pydantic" not in told


def test_lines_are_done_at_once_and_go_on_while_others_are_asked(at_the_table: Collaborator) -> None:
    mind = at_the_table
    said = mind.right("do", line="do television look frames 3000 with floor stand frames 3000", wait_s=0.2)
    number = re.search(r"Line (\d+) goes on .*call wait with number=(\d+)", said)
    assert number is not None
    assert number[1] == number[2]
    assert "goes on since" in mind.right("wait", number=int(number[1]), seconds=0.2)
    assert f"line {number[1]}" in mind.right("where_am_i")
    assert mind.right("stop") == "Stopped."
    assert "cancelled" in mind.wrong("wait", number=int(number[1]))
    assert "the last are: " in mind.wrong("wait", number=9999)
    assert "column 7: the line ends here; expected: an action" in mind.wrong("do", line="do cup")


def test_it_waits_for_seconds_and_states_and_is_told_how_to_ask(at_the_table: Collaborator) -> None:
    mind = at_the_table
    assert "0.3 s have passed" in mind.right("wait", seconds=0.3)
    assert mind.right("wait", condition="lamp light == on") == "lamp light is on."
    assert "light is on after 0.2 s, not == off" in mind.wrong("wait", condition="lamp light == off", seconds=0.2)
    assert 'never "green"; allowed: off, on' in mind.wrong("wait", condition="lamp light == green")
    assert "it has: light" in mind.wrong("wait", condition="lamp power == on")
    assert "write it as: lamp light == on" in mind.wrong("wait", condition="lamp light = on")
    assert "write it as OBJECT STATE OP VALUE" in mind.wrong("wait", condition="5")
    assert "allowed: 0 to 300" in mind.wrong("wait", seconds=1000)


@pytest.mark.skipif(find_headless() is None, reason="this machine draws nothing without a window")
def test_it_gets_a_picture_of_what_is_before_its_eyes(at_the_table: Collaborator) -> None:
    answer = at_the_table.call("look", at="room/table", names=False)
    assert not answer.error, answer.text
    picture = np.asarray(Image.open(io.BytesIO(answer.pictures[0])).convert("RGB")).astype(int)
    assert picture.shape == (480, 640, 3)
    middle = picture[200:280, 280:360].reshape(-1, 3).mean(axis=0)
    assert middle[0] > middle[1] + 20 > middle[2] + 40  # the table's wood
    assert re.search(r"^room/table: ", answer.text, re.M)
    assert "not in sight" not in answer.text
    assert answer.text.count("\n") < at_the_table.right("list_objects").count("\n")
    assert "three numbers" in at_the_table.wrong("look", at="1 2")


def test_without_a_main_it_says_how_to_start_one() -> None:
    with pytest.raises(NoAnswer) as caught:
        make_server(Mind("1", timeout=0.3))
    said = str(caught.value)
    assert said.startswith("no main answers at 127.0.0.1:1; start one with `ahmss up --port 1`")
    assert said.endswith("or let it start a world of its own: ahmss mcp --scene room")


def test_a_scene_that_is_none_is_said_to_be_none(
    monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(sys, "argv", ["ahmss", "mcp", "--scene", "rom"])
    with pytest.raises(SystemExit) as ended:
        cli.main()
    out, said = capfd.readouterr()
    assert (ended.value.code, out) == (1, "")
    assert 'ahmss: the main process did not start: no kind of object "rom", did you mean "room"?' in said
    assert "Traceback" not in said


def test_without_the_package_it_says_what_to_install() -> None:
    program = "import sys; sys.modules['mcp'] = None; from ahmss.cli import main; main()"
    done = subprocess.run(
        [sys.executable, "-c", program, "mcp"], stdin=subprocess.DEVNULL, capture_output=True, text=True, timeout=50,
        check=False,
    )  # fmt: skip
    assert done.returncode == 1
    assert done.stderr.strip() == "ahmss: the package mcp is missing; install it: pip install 'ahmss[mcp]'"


@pytest.mark.long
def test_the_room_is_worked_through_by_what_the_sentences_say() -> None:
    with collaborate("--scene", "room", "--at", "-0.6", "0.5", "--facing", "-40") as mind:
        assert "angle is 0.0" in mind.wrong("act", object="door", action="close")
        assert "it affords now: reach, close" in mind.right("act", object="door", action="open")
        mind.right("act", object="floor", action="walk", to="-0.2 0.7")
        mind.right("act", object="door", action="close")
        mind.right("act", object="floor", action="walk", to="television")
        assert "power is on" in mind.right("act", object="television", action="press")
        assert mind.right("wait", condition="television power == on") == "television power is on."
        mind.right("do", line="do floor walk to cup with cup reach then cup grasp then cup lift then cup carry")
        mind.right("do", line="do floor walk to tap with cup carry")
        mind.right("do", line="do tap turn with cup carry")
        assert "allowed: shut, running" in mind.wrong("wait", condition="tap flow == open")
        assert mind.right("wait", condition="tap flow == running", seconds=5) == "tap flow is running."
        assert "room/cup in the " in mind.right("where_am_i")


@pytest.mark.long
@pytest.mark.timeout(300)
def test_the_pump_is_started_by_who_was_told_the_tools_alone_and_reads_why_not() -> None:
    """A fixed plan; whatever comes next is taken from what was said before."""
    with collaborate("--scene", "control_room", "--at", "0.6", "0.3") as mind:
        listed = mind.right("list_objects")
        pump = re.search(r"^(\S+): A pump .*running is off", listed, re.M)
        starts = re.search(r"(\w+) starts the pump once the (\w+) allows it", listed)
        valve = re.search(r"(\w+) is the valve whose pressure (\w+) shows", listed)
        assert pump is not None
        assert starts is not None
        assert valve is not None
        # It can't be started itself; what it affords is to look, and that says that it stands still.
        affords = re.search(r"it affords: (\w+)", mind.wrong("act", object=pump[1], action="start"))
        assert affords is not None
        assert "running is off" in mind.right("act", object=pump[1], action=affords[1])
        # The button alone does nothing, and the state waited for says so.
        assert "did you mean button_" in mind.wrong("act", object="button", action="press")
        mind.right("act", object=starts[1], action="press")
        assert "running is off after" in mind.wrong("wait", condition=f"{pump[1]} running == on", seconds=1)
        assert "enabled is no" in next(line for line in mind.right("list_objects").splitlines() if pump[1] in line)
        # The key does not turn under its cover; what does it afford now?
        said = mind.wrong("act", object=starts[2], action="turn")
        opens = re.search(r"only when its cover is open; .*it affords now: (\w+)", said)
        assert opens is not None
        mind.right("act", object=starts[2], action=opens[1])
        # A position that it does not have: those that it has.
        said = mind.wrong("act", object=starts[2], action="turn", parameters={"position": "start"})
        there = re.search(r"it has: off, (\w+)", said)
        assert there is not None
        told = mind.right("act", object=starts[2], action="turn", parameters={"position": there[1]})
        assert f"position is {there[1]}" in told
        mind.right("act", object=starts[1], action="press")
        assert mind.right("wait", condition=f"{pump[1]} running == on", seconds=5) == f"{pump[1]} running is on."
        # And its valve, by a level out of range first.
        ranged = re.search(
            r"allowed: (\S+) to (\S+)", mind.wrong("act", object=valve[1], action="slide", parameters={"level": 60})
        )
        assert ranged is not None
        mind.right("act", object=valve[1], action="slide", parameters={"level": 0.6 * float(ranged[2])})
        shown = re.search(r"value is (\S+)", mind.right("act", object=valve[2], action="check"))
        assert shown is not None
        assert float(shown[1]) == pytest.approx(0.6, abs=0.02)
