"""The console: shows the dialogue's questions, takes answers or whole lines, and lets the frames run meanwhile."""

from __future__ import annotations

import os
import sys
import threading
import time
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Protocol

from ahmss.errors import AhmssError
from ahmss.main.catalogue import WorldCatalogue
from ahmss.main.command import Do, Line
from ahmss.main.completion import candidates
from ahmss.main.dialogue import Dialogue, Listing, Question
from ahmss.main.process import MainProcess, Setup
from ahmss.main.script import Step

__all__ = ["Console", "run_console"]

_NAP = 0.01
_COMMANDS = ("help", "undo", "list", "stop", "quit")
_HELP = """\
Answer the question, or type a whole line:
  do floor walk to cup                  walk to an object, or a place: to 1.2 0.5
  do cup grasp                          one motion
  do cup reach with television look     two motions at once (fused)
  do cup put to 0.42 -0.15 0.88         with a goal
  do cup grasp frames 60 after 20       in 60 frames, beginning 20 frames later
  add cup at 1 2 0.8 facing 90          an object at x y z, turned by degrees
  add                                   an object, question by question
  remove cup   set lamp light off   wait 1.5   wait lamp light == off
Other words: undo (the last answer), list (the objects), stop (the motion; also Ctrl-C), quit (also Ctrl-D).\
"""


class Terminal(Protocol):
    """Where the console reads and writes."""

    def ask(self, prompt: str, candidates: Callable[[str], Sequence[str]]) -> str:
        """A line; EOFError at the end, KeyboardInterrupt at Ctrl-C. `candidates` complete what was typed."""
        ...

    def say(self, text: str) -> None:
        """A line for the person; from any thread."""
        ...

    def show(self, listing: Listing) -> None:
        """A list to choose from."""
        ...


class Console:
    """One person's dialogue with one main.

    Args:
        waits: read the next answer only when the one before has been carried out, motions too (for piped input).
    """

    def __init__(self, main: MainProcess, terminal: Terminal, *, waits: bool) -> None:
        self.catalogue = WorldCatalogue(main.workspace, main.communication, lambda: main.actor)
        self._main, self._terminal, self._waits = main, terminal, waits
        self._dialogue = Dialogue(self.catalogue)
        self._over = False
        self._shown: Question | None = None
        self._objects: tuple[str, ...] | None = None
        main.agenda.said = terminal.say

    def _candidates(self, text: str) -> Sequence[str]:
        """What may stand in the place of the last word of `text`."""
        return candidates(text, self.catalogue, (*self._dialogue.question.words, *_COMMANDS))

    def run(self, first: Sequence[Line] = ()) -> None:
        """Talk until `quit` or the end of the input; the frames run in a thread of their own."""
        frames = threading.Thread(target=self._main.run, args=(lambda: self._over,), name="frames")
        self._main.agenda.set_the_scene(first)
        frames.start()
        try:
            while self._main.agenda.scene:
                time.sleep(_NAP)
            while self._talk():
                pass
            while self._waits and not self._main.agenda.done:
                time.sleep(_NAP)
        finally:
            self._over = True
            frames.join()

    def _talk(self) -> bool:
        """One question and its answer; False at the end."""
        try:
            question = self._dialogue.question
            self._show(question)
            text = self._terminal.ask(f"{question.prompt}> ", self._candidates).strip()
            return self._understand(text)
        except EOFError:
            return False
        except KeyboardInterrupt:
            self._stop()
        except AhmssError as error:
            self._terminal.say(str(error))
        return True

    def _stop(self) -> None:
        self._main.stop_motion()
        self._dialogue.reset()
        self._terminal.say("stopped")

    def _show(self, question: Question) -> None:
        """What there is to choose from; the objects only at first and when others have come or gone."""
        listing = question.listing
        if listing is not None and question.opening:
            if listing.names != self._objects:
                self._terminal.show(listing)
            self._objects = listing.names
        elif listing is not None and question != self._shown:
            self._terminal.show(listing)
        self._shown = question

    def _understand(self, text: str) -> bool:
        match text:
            case "quit" | "exit":
                return False
            case "help" | "?":
                self._terminal.say(_HELP)
            case "undo":
                if not self._dialogue.undo():
                    self._terminal.say("there is no answer to take back")
            case "list":
                self._terminal.show(self.catalogue.objects())
            case "stop":
                self._stop()
            case _:
                line = self._dialogue.answer(text)
                if line is not None:
                    self._carry_out(line)
        return True

    def _carry_out(self, line: Line) -> None:
        """Hand a line to the frame loop; what takes no motion is waited for, so that the next list shows it."""
        self._main.agenda.add(Step(line, 0, ""))
        while not self._main.agenda.done and (self._waits or not isinstance(line, Do)):
            if isinstance(line, Do) or not self._waiting_for_motion():
                time.sleep(_NAP)
            else:
                break

    def _waiting_for_motion(self) -> bool:
        """On a terminal a line that stands behind a motion is not waited for."""
        return not self._waits and self._main.control.busy


class _Plain:
    """Pipes and files: no colours, no history."""

    def ask(self, prompt: str, candidates: Callable[[str], Sequence[str]]) -> str:
        """A line of standard input."""
        del candidates
        print(prompt, end="", flush=True)
        line = sys.stdin.readline()
        if not line:
            raise EOFError
        print(line.rstrip("\n"), flush=True)
        return line

    def say(self, text: str) -> None:
        """A line on standard output."""
        print(text, flush=True)

    def show(self, listing: Listing) -> None:
        """The names and their sentences."""
        width = max((len(name) for name in listing.names), default=0)
        lines = [f"  {name:<{width}}  {sentence}".rstrip() for name, sentence in listing.entries]
        print("\n".join([f"{listing.title}:", *lines] if lines else [f"{listing.title}: none"]), flush=True)


def run_console(setup: Setup, first: Sequence[Line] = ()) -> int:
    """A main with its console; returns how many things went wrong.

    Raises:
        AhmssError: no such body, or no server.
    """
    on_terminal = sys.stdin.isatty() and sys.stdout.isatty()
    terminal: Terminal = _Plain()
    main = MainProcess(setup, lambda text: terminal.say(text))
    try:
        if on_terminal:
            from ahmss.main.terminal import PersonsTerminal

            terminal = PersonsTerminal(_history())
        terminal.say(f"{setup.human} is in the world on {main.communication.client.address}; type help for help")
        if main.port is not None:
            terminal.say(f"human models reach {setup.human} at {main.port.address}")
        Console(main, terminal, waits=not on_terminal).run(first)
    finally:
        main.close()
    return 0 if on_terminal else main.report.failures


def _history() -> Path | None:
    """The file of what was typed before; None where none can be kept."""
    base = Path(os.environ.get("XDG_STATE_HOME") or Path.home() / ".local" / "state")
    try:
        (base / "ahmss").mkdir(parents=True, exist_ok=True)
        path = base / "ahmss" / "history"
        path.touch()
    except OSError:
        return None
    return path
