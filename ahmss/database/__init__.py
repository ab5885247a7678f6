"""objectdb/, humandb/ and algorithms/: typed records from what users wrote, seen afresh at every look-up."""

from __future__ import annotations

from ahmss.database.objects import Listing, ObjectDatabase
from ahmss.database.placement import Changes, Placed, difference
from ahmss.database.records import (
    Affordance,
    AlgorithmEntry,
    Contained,
    HumanModel,
    ObjectKind,
    Site,
    State,
)
from ahmss.database.shape import Shape
from ahmss.database.texture import Texture
from ahmss.database.workspace import Workspace

__all__ = [
    "Affordance",
    "AlgorithmEntry",
    "Changes",
    "Contained",
    "HumanModel",
    "Listing",
    "ObjectDatabase",
    "ObjectKind",
    "Placed",
    "Shape",
    "Site",
    "State",
    "Texture",
    "Workspace",
    "difference",
]
