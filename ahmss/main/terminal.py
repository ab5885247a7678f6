"""A person's terminal: completion, history, and messages that do not break the line being typed."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from pathlib import Path

from prompt_toolkit import PromptSession
from prompt_toolkit.completion import CompleteEvent, Completer, Completion
from prompt_toolkit.document import Document
from prompt_toolkit.history import FileHistory, InMemoryHistory
from prompt_toolkit.patch_stdout import patch_stdout
from rich.console import Console as RichConsole
from rich.table import Table

from ahmss.main.dialogue import Listing

__all__ = ["PersonsTerminal"]


class _Completer(Completer):
    """Offers the candidates that begin with the word before the cursor."""

    def __init__(self, candidates: Callable[[str], Sequence[str]]) -> None:
        self._candidates = candidates

    def get_completions(self, document: Document, complete_event: CompleteEvent) -> Iterable[Completion]:
        """As prompt_toolkit asks for them."""
        del complete_event
        text = document.text_before_cursor
        word = text.rsplit(" ", 1)[-1]
        for candidate in self._candidates(text):
            if candidate.startswith(word) and candidate != word:
                yield Completion(candidate, start_position=-len(word))


class PersonsTerminal:
    """Reads by prompt_toolkit and writes above the prompt."""

    def __init__(self, history: Path | None) -> None:
        self._session: PromptSession[str] = PromptSession(
            history=FileHistory(str(history)) if history is not None else InMemoryHistory(),
            complete_while_typing=False,
        )

    def ask(self, prompt: str, candidates: Callable[[str], Sequence[str]]) -> str:
        """A line that was typed."""
        with patch_stdout(raw=True):
            return self._session.prompt(prompt, completer=_Completer(candidates))

    def say(self, text: str) -> None:
        """A line above the prompt, broken between words where it is longer than the terminal is wide."""
        RichConsole(highlight=False, markup=False, emoji=False).print(text)

    def show(self, listing: Listing) -> None:
        """A table of names and sentences."""
        table = Table(show_header=False, box=None, pad_edge=False)
        table.add_column(no_wrap=True)
        table.add_column()
        for name, sentence in listing.entries or (("none", ""),):
            table.add_row(f"  {name}", sentence)
        console = RichConsole(highlight=False, markup=False)
        console.print(f"{listing.title}:")
        console.print(table)
