"""A real client of the Model Context Protocol, with `ahmss mcp` and its world in processes of their own."""

from __future__ import annotations

import base64
import sys
from collections.abc import AsyncGenerator, Callable, Generator, Iterator
from contextlib import asynccontextmanager, contextmanager
from dataclasses import dataclass, field
from typing import Any

import pytest
from anyio.from_thread import start_blocking_portal
from mcp import ClientSession, StdioServerParameters, stdio_client


@dataclass
class Answer:
    """What a tool said."""

    error: bool
    text: str
    pictures: list[bytes] = field(default_factory=list[bytes])


@dataclass
class Collaborator:
    """The client's side: what it was told at the start, and its calls."""

    instructions: str
    tools: dict[str, Any]
    call: Callable[..., Answer]

    def right(self, tool: str, **arguments: Any) -> str:
        """A call that must succeed; what it said."""
        answer = self.call(tool, **arguments)
        assert not answer.error, answer.text
        return answer.text

    def wrong(self, tool: str, **arguments: Any) -> str:
        """A call that must be refused, or fail; what it said."""
        answer = self.call(tool, **arguments)
        assert answer.error, answer.text
        assert "Traceback" not in answer.text
        assert "fault of the program" not in answer.text
        return answer.text


@asynccontextmanager
async def session(*arguments: str) -> AsyncGenerator[ClientSession]:
    """`ahmss mcp` with these arguments, and a session with it."""
    parameters = StdioServerParameters(command=sys.executable, args=["-m", "ahmss", "mcp", *arguments])
    async with stdio_client(parameters) as (read, write), ClientSession(read, write) as one:
        yield one


@contextmanager
def collaborate(*arguments: str) -> Generator[Collaborator]:
    """A collaborator with a world of its own."""
    with start_blocking_portal() as portal, portal.wrap_async_context_manager(session(*arguments)) as one:
        begun = portal.call(one.initialize)
        listed = portal.call(one.list_tools)

        def call(tool: str, **given: Any) -> Answer:
            result = portal.call(one.call_tool, tool, given)
            texts = [part.text for part in result.content if part.type == "text"]
            pictures = [base64.b64decode(part.data) for part in result.content if part.type == "image"]
            return Answer(bool(result.is_error), "\n".join(texts), pictures)

        yield Collaborator(begun.instructions or "", {tool.name: tool for tool in listed.tools}, call)


@pytest.fixture(scope="module")
def at_the_table() -> Iterator[Collaborator]:
    """In the room, the table with the cup in front."""
    with collaborate("--scene", "room", "--at", "0", "0", "--facing", "-20") as one:
        yield one
