"""What hands will ask of the shapes of objects, made before one of them does: a field of distances takes a second."""

from __future__ import annotations

import contextlib
import os
from collections.abc import Iterable, Iterator
from itertools import product
from pathlib import Path

import numpy as np

from ahmss.algorithm.shape import TargetShape
from ahmss.body.array import Array
from ahmss.database.workspace import Workspace
from ahmss.errors import AhmssError

__all__ = ["make_fields"]

_YIELDS = 5  # of priority: what is under way goes first, and pictures, which yield by 10, later


def make_fields(root: Path, kinds: Iterable[str]) -> None:
    """Make what is not kept yet of the distances around the sites where objects of some kinds are taken.

    What can't be read is told by the motion that asks for it.

    Args:
        root: the workspace's folder.
        kinds: of objects.
    """
    os.nice(_YIELDS)
    workspace = Workspace(root)
    for kind in kinds:
        with contextlib.suppress(AhmssError, ValueError):
            places = list(_places(workspace, kind))
            kept = workspace.objects.kept_shape(kind) if places else None
            if kept is not None:
                shape = TargetShape(str(kept[0]), kept[1])
                for part, place in product((shape, shape.rest), places):
                    with contextlib.suppress(ValueError):  # nothing of it is there
                        if part is not None:
                            part.field(place)


def _places(workspace: Workspace, kind: str) -> Iterator[Array]:
    """The places (3,), in the frame of an object of a kind, around which its motions ask for distances."""
    record = workspace.objects.get(kind)
    told: set[str] = set()
    for affordance in record.affordances.values():
        site = affordance.site or ""
        names = [name for name in (affordance.human_algorithm, affordance.object_algorithm) if name]
        if site in told or not any(workspace.algorithms.find(name).shape for name in names):
            continue
        if site not in record.sites and affordance.hold in ("", "keep"):
            continue  # a floor: hands reach over it for a place, not for it; what is carried is in the hand already
        told.add(site)
        yield np.array(record.sites[site].position) if site in record.sites else np.zeros(3)
