"""How far a motion is, and that it has come to rest."""

from __future__ import annotations

from dataclasses import dataclass

__all__ = ["Progress", "Rested"]


class Rested(Exception):
    """A motion that was to come to rest has done so: it ends here, and nothing is wrong."""


@dataclass
class Progress:
    """How far a motion is, whatever copies of its task there are.

    rests: it is to come to rest now, and to end. arrived: it is where it acts. closed: the hand has closed.
    """

    rests: bool = False
    arrived: bool = False
    closed: bool = False
