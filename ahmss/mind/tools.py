"""What a language model can do as the mind of a human: the tools of `ahmss mcp`, and what each says of itself.

A refusal is a tool error of one sentence that says what would have been right. Every call has a connection of its own,
so that one that waits holds up no other.
"""

from __future__ import annotations

from collections.abc import Generator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from mcp.server.mcpserver import Context, Image, MCPServer
from mcp.server.mcpserver.exceptions import ToolError
from mcp_types import CallToolResult, InputRequiredResult, Tool
from pydantic import ValidationError

from ahmss.client import Client, Handle
from ahmss.database.document import one_of
from ahmss.errors import AhmssError, CommandError, NoAnswer, PortRefused
from ahmss.main.command import Wait, parse
from ahmss.mind import words
from ahmss.mind.arguments import unknown, wrong
from ahmss.mind.picture import picture
from ahmss.port.acts import place_in

__all__ = ["Mind", "make_server"]

_INSTRUCTIONS = """\
You move one human body in a room. Objects say themselves what can be done with them, and that changes with their \
states and with what you hold. So: list_objects to see what is here; what_can_i_do with one of them; act. What can't \
be done is refused with the reason and with what would be right: read it, and do that. Most things must be near: walk \
first, with act(object="floor", action="walk", to="the object's name"). To take a thing: grasp, which reaches for it \
first. act waits for the end and tells what came of it. A switch that is pressed twice is off again: see the states \
before you act."""
_MOST_S = 300.0
_NO_OTHERS = {"additionalProperties": False}


@dataclass(frozen=True)
class Mind:
    """Where the human is reached. server: the world's address for pictures; "" is as the main says.

    timeout: seconds within which the main answers.
    """

    port: str = ""
    keys: Path | None = None
    server: str = ""
    server_keys: Path | None = None
    timeout: float = 5.0

    @contextmanager
    def human(self) -> Generator[Client]:
        """A connection to the main; what it refuses is an error that the model reads."""
        try:
            with Client(self.port, keys=self.keys, timeout=self.timeout) as client:
                yield client
        except (AhmssError, TimeoutError) as error:
            raise ToolError(str(error)) from error

    # The tools. Their docstrings are what a model is told.

    def where_am_i(self) -> str:
        """Tell who you are, where you stand and face, what you hold, what is being done, and who else is here."""
        with self.human() as client:
            me = client.me()
            others = [words.person(other) for other in client.humans()]
            return "\n".join([words.self_told(me), *self._gestures(client, me.human), *others])

    def list_objects(self, seen_only: bool = False) -> str:
        """List the objects here, near ones first: name, what it is, distance, direction, place (x y z), states.

        Args:
            seen_only: only those before your eyes now (within 60 degrees of your line of sight, and not hidden).
        """
        with self.human() as client:
            things = client.seen() if seen_only else client.objects()
            return words.objects(things) or ("You see no object from here." if seen_only else "Nothing is here.")

    def what_can_i_do(self, object: str) -> str:  # noqa: A002 - what a model reads is named as it should read
        """List what an object affords you now, with what each action needs; and what it does not afford now, and why.

        Every action takes the parameter patience, too: seconds to wait for what another has, 0 to 3600 (usually 10).

        Args:
            object: its name as list_objects has it, or the last part of it (cup for room/cup).
        """
        with self.human() as client:
            return words.affordances(client.afforded(object))

    def act(
        self,
        object: str,  # noqa: A002
        action: str,
        to: str = "",
        facing_deg: float | None = None,
        hand: str = "",
        frames: int | None = None,
        parameters: dict[str, str | float] | None = None,
        wait_s: float = 60.0,
    ) -> str:
        """Do one action with an object and wait for its end; tell what came of it and what the object affords then.

        To walk to a thing: object="floor", action="walk", to="cup". Leave out what what_can_i_do does not ask for.

        Args:
            object: its name; or "x y z", metres, for what is at that place.
            action: one that what_can_i_do lists as afforded now.
            to: the goal: another object's name, or "x y" or "x y z" in metres.
            facing_deg: which way to face at the goal, degrees: 0 is +x, 90 is +y.
            hand: "left" or "right"; left out, the nearer free one.
            frames: how long it takes, 60 to the second, at least 1; left out, as the action has it.
            parameters: of the action, as what_can_i_do lists them; of every action: patience, seconds.
            wait_s: seconds to wait for its end, 0 to 300; it goes on after that, and wait tells its end.
        """
        with self.human() as client:
            handle = client.do(
                object, action, to=to, facing_deg=facing_deg, hand=hand, frames=frames, parameters=parameters
            )
            return self._end(client, handle, wait_s, "" if place_in(object) else object)

    def do(self, line: str, wait_s: float = 60.0) -> str:
        """Do several actions at once or one after another, by one line; wait for the end as act does.

        `with` makes motions together, `then` one after the other, `after N` begins one N frames later:
            do cup reach with television look after 12
            do floor walk to cup with cup reach then cup grasp
            do chair sit with cup carry
            do cup put to 0.42 -0.15 0.88 hand right frames 60
        Each act is OBJECT ACTION, then any of: to X Y Z | to OBJECT | facing DEG | hand left | hand right | KEY=VALUE |
        frames N | after N.

        Args:
            line: begins with do.
            wait_s: as in act.
        """
        with self.human() as client:
            return self._end(client, client.do_line(line), wait_s, "")

    def wait(self, seconds: float = 10.0, number: int | None = None, condition: str = "") -> str:
        """Wait for some seconds, or for the end of a line of act or do, or until an object's state is so.

        Args:
            seconds: how long at most, 0 to 300.
            number: of a line that goes on, as act told it.
            condition: "OBJECT STATE OP VALUE", where OP is == != < <= > or >=, as in "lamp light == on" or
                "gauge_3 value > 0.8".
        """
        seconds = _seconds(seconds)
        with self.human() as client:
            if number is not None:
                client.result(number)  # refuses a number that is none
                return self._end(client, Handle(client, number, f"line {number}"), seconds, "")
            if condition:
                line = _condition(condition)
                value = client.wait_until(line.object, line.state, line.operator, line.value, timeout=seconds)
                return f"{line.object} {line.state} is {value}."
            client.pause(seconds)
            return f"{seconds:g} s have passed. {words.self_told(client.me())}"

    def stop(self) -> str:
        """Stop what you do at once, and forget what waits. What you hold stays in your hand."""
        with self.human() as client:
            client.stop()
            return "Stopped."

    def look(self, at: str = "", names: bool = True) -> list[Any]:
        """Get a picture of what is before your eyes, and the list of what you see. It takes some seconds.

        Args:
            at: an object to turn the eyes to, even behind you, or "x y z" in metres; left out, where your head faces.
            names: whether names are written into the picture.
        """
        with self.human() as client:
            me = client.me()
            target = place_in(at) or (client.object(at).place if at else ())
            if at and len(target) != 3:
                raise CommandError(f'at "{at}": a place has three numbers, x y z in metres')
            seen = words.objects(client.seen())
            data = picture(self.server or me.server, me.human, target, names=names, keys=self.server_keys)
            told = [words.behind(me, at, target)] if at else []
        return [Image(data=data, format="png"), *filter(None, told), seen or "You see no object from here."]

    # How

    def _end(self, client: Client, handle: Handle, seconds: float, name: str) -> str:
        """Wait for the end of a line, and tell it; one that failed is an error, with what is afforded now."""
        try:
            result = handle.wait(_seconds(seconds), check=False)
        except TimeoutError:
            result = handle.progress
        told = words.outcome(result, client.me().rate)
        if name and result.status in ("done", "failed"):
            told += f"\n{self._afterwards(client, name)}"
        if result.status in ("failed", "cancelled"):
            raise ToolError(told)
        return told

    @staticmethod
    def _gestures(client: Client, human: str) -> list[str]:
        """What the body affords itself, where the workspace has that."""
        try:
            names = [action.name for action in client.afforded(human).now]
        except PortRefused:
            return []
        return [f'With object="{human}", yourself, you can: {", ".join(names)}.'] if names else []

    @staticmethod
    def _afterwards(client: Client, name: str) -> str:
        """An object's states and what it affords, after an action."""
        thing, offers = client.object(name), client.afforded(name)
        states = ", ".join(f"{state} is {value}" for state, value in thing.states.items())
        now = ", ".join(action.name for action in offers.now) or "nothing"
        return f"{thing.name}: {states + '; ' if states else ''}it affords now: {now}"


def make_server(mind: Mind) -> MCPServer[Any]:
    """The server with all tools.

    Raises:
        NoAnswer: no main is there.
    """
    with Client(mind.port, keys=mind.keys, timeout=mind.timeout) as client:
        try:
            me = client.me()
        except NoAnswer as error:
            raise NoAnswer(f"{error}; or let it start a world of its own: ahmss mcp --scene room") from None
    server = _Server("ahmss", instructions=f"{_INSTRUCTIONS}\n{words.self_told(me)}", log_level="WARNING")
    for tool in (
        mind.where_am_i, mind.list_objects, mind.what_can_i_do, mind.act, mind.do, mind.wait, mind.stop, mind.look,
    ):  # fmt: skip
        server.add_tool(tool, structured_output=False)
    return server


class _Server(MCPServer[Any]):
    """Refuses a tool that is none, an argument that a tool does not have, or that is of a wrong type, in a sentence
    that says what to give.

    Without the second, something else would be done than was asked.
    """

    async def list_tools(self) -> list[Tool]:
        """All tools; their schemas say that they have no other arguments."""
        tools = await super().list_tools()
        return [tool.model_copy(update={"input_schema": tool.input_schema | _NO_OTHERS}) for tool in tools]

    async def call_tool(
        self, name: str, arguments: dict[str, Any], context: Context[Any, Any] | None = None
    ) -> CallToolResult | InputRequiredResult:
        """What a tool says. ToolError: there is no such tool, it takes no such argument, or as the tool says."""
        tools = {tool.name: tool for tool in await self.list_tools()}
        tool = tools.get(name)
        if tool is None:
            raise ToolError(f'no tool "{name}"{one_of(name, tools)}')
        if refused := unknown(name, arguments, tool.input_schema):
            raise ToolError(refused)
        try:
            return await super().call_tool(name, arguments, context)
        except ToolError as error:
            if not isinstance(error.__cause__, ValidationError):
                raise
            (argument, *_) = error.__cause__.errors()[0]["loc"]
            raise ToolError(
                wrong(name, arguments, str(argument), tool.input_schema, tool.description or "")
            ) from error.__cause__


def _seconds(seconds: float) -> float:
    if not 0.0 <= seconds <= _MOST_S:
        raise ToolError(f"{seconds:g} s can't be waited for at once; allowed: 0 to {_MOST_S:g}")
    return seconds


def _condition(text: str) -> Wait:
    """A condition, read by the grammar of scripts."""
    try:
        line = parse(f"wait {text}")
    except CommandError as error:
        raise CommandError(f'condition "{text}": {error}; write it as: lamp light == on') from None
    if not isinstance(line, Wait) or not line.object:
        raise CommandError(f'condition "{text}": write it as OBJECT STATE OP VALUE, as in: lamp light == on')
    return line
