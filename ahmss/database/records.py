"""What the database hands out: frozen records, metres and radians, rotations wxyz.

One record a kind serves all objects of that kind; what differs between two of them (pose, states, who holds it) is in
the world, not here.
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import msgspec

from ahmss.body.skeleton import Skeleton
from ahmss.database.parameter import Parameter
from ahmss.states.behaviour import Appearance, Behaviour, Consequence
from ahmss.states.condition import Condition
from ahmss.states.state import State

__all__ = [
    "Affordance",
    "AlgorithmEntry",
    "Contained",
    "HumanModel",
    "ObjectKind",
    "Quaternion",
    "Site",
    "State",
    "Vector",
]

Vector = tuple[float, float, float]
Quaternion = tuple[float, float, float, float]


class Site(msgspec.Struct, frozen=True):
    """A named frame on an object, in the object's frame.

    With `free_axis = "z"` the site's turn about its z axis is free: an algorithm turns it so that its x points away
    from the acting human. grip: how a hand takes it, "power" or "precision"; "" where nothing is said.
    part: of a human, in whose frame it is then: "eyes", "right_palm", "left_palm", or a link; "": the object's frame.
    """

    position: Vector = (0.0, 0.0, 0.0)
    rotation: Quaternion = (1.0, 0.0, 0.0, 0.0)
    free_axis: str = ""
    grip: str = ""
    part: str = ""


class Affordance(msgspec.Struct, frozen=True):
    """One action that an object affords: with which algorithms, data, place on it, and under which conditions.

    asks: what the dialogue asks besides the number of frames, of goal_position, facing, goal_posture, hand.
    frames: how many it takes if nobody says; 0: the algorithm ends it itself.
    needs: what the human must have: reach (highest grip, metres), stature (metres), free_hands and full_hands (0 to 2),
        standing (1: who sits on something stands up from it first).
    hold: "" (an object algorithm claims the object for the motion only), "take" (the object is claimed and its
    algorithm goes on after the motion), "keep" (must be held by this human), "release" (lets it go); of a human "give"
    (what is in the hand becomes theirs) and "receive" (what they hold becomes one's own).
    first: the name of the action that brings the hand to the object, made first by whose hand is not there yet.
    of: the name of what the object contains and what affords the action in its place; "": the object itself.
    """

    name: str
    human_algorithm: str
    object_algorithm: str | None = None
    sentence: str = ""
    motion: Path | None = None
    site: str | None = None
    asks: tuple[str, ...] = ()
    parameters: dict[str, Any] = {}
    when: Condition | None = None
    needs: dict[str, float] = {}
    frames: int = 60
    hold: str = ""
    first: str = ""
    of: str = ""


class Contained(msgspec.Struct, frozen=True, gc=False):
    """An object that is part of another: its kind, its name there, and its pose in the other's frame."""

    kind: str
    name: str
    position: Vector = (0.0, 0.0, 0.0)
    rotation: Quaternion = (1.0, 0.0, 0.0, 0.0)


class ObjectKind(msgspec.Struct, frozen=True):
    """All that is common to the objects of one kind (figure 4.12 of the thesis)."""

    name: str
    directory: Path
    sentence: str = ""
    shape: Path | None = None
    unit: str = "m"
    up: str = ""
    two_sided: bool | None = None
    color: tuple[int, int, int] | None = None
    texture: Path | None = None
    texture_layers: tuple[str, ...] = ()
    texture_size: float = 0.0
    properties: dict[str, Any] = {}
    sites: dict[str, Site] = {}
    affordances: dict[str, Affordance] = {}
    states: dict[str, State] = {}
    appearances: tuple[Appearance, ...] = ()
    consequences: tuple[Consequence, ...] = ()
    falls: bool = True
    contains: tuple[Contained, ...] = ()

    @property
    def behaviour(self) -> Behaviour:
        """What of it the world and the viewers must know."""
        return Behaviour(self.states, self.appearances, self.consequences, self.falls)

    @property
    def initial_states(self) -> dict[str, str | float]:
        """The states of a new object of this kind."""
        return {name: state.initial for name, state in self.states.items()}

    @property
    def lets_go(self) -> str:
        """The action by which a hand lets go of it where it is; "" where there is none."""
        ways = (name for name, one in self.affordances.items() if one.hold == "release" and not one.asks)
        return next(ways, "")

    def afforded(self, states: Mapping[str, str | float]) -> dict[str, Affordance]:
        """The affordances whose `when` holds in these states."""
        return {n: a for n, a in self.affordances.items() if a.when is None or a.when.holds(states)}


class AlgorithmEntry(msgspec.Struct, frozen=True):
    """A program that makes motion: how to start it and what it takes.

    kind: "human", "object", or "" where nothing says (a bare executable). argv: the first is "python" for the pool,
    else a program (an absolute path, or a name on the PATH), started in `directory`. world: what of it START brings.
    footprints: whether START says which area on the floor each object occupies. humans: whether it brings the others;
    ways: and whether it and each FRAME say where they mean to be; arms: and, of those near, where their arms are.
    shape: whether START says where the target's shape is kept; shapes: where those of what occupies the floor are.
    carries: whether its motion carries the body elsewhere, so that others made with it leave hips and legs to it.
    accompanies: whether its motion lasts as long as those made with it, where nobody says for how long.
    stretches: whether it takes longer than its action's frames, where these are too few and nobody asks for so many.
    fewest: the share of its action's frames that it takes at least, where somebody asks for fewer.
    rests: whether its motion comes to rest where it is to be given up, rather than to end with the next frame.
    arrives: whether it comes to where it acts first, and says so: what it moves is claimed then, and where it is to be
    given up on its way it comes to rest.
    catches: of an object, whether it is told when the hand has closed on it.
    parameters: None where nothing declares them: then any will do.
    """

    name: str
    kind: str
    argv: tuple[str, ...]
    directory: Path
    sentence: str = ""
    parameters: dict[str, Parameter] | None = None
    world: str = "near"
    footprints: bool = False
    humans: bool = False
    shape: bool = False
    carries: bool = False
    accompanies: bool = False
    ways: bool = False
    stretches: bool = False
    rests: bool = False
    arrives: bool = False
    arms: bool = False
    fewest: float = 0.0
    catches: bool = False
    shapes: bool = False


class HumanModel(msgspec.Struct, frozen=True):
    """A human of humandb/: its skeleton and what it looks like (a GLB skinned to the 43 links in their order)."""

    name: str
    skeleton: Skeleton
    shape: Path
    directory: Path
    texture: Path | None = None
    sentence: str = ""
