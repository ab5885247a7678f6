"""Where the sites that belong to parts of a body are: only the links between them and the hips are computed."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np

from ahmss.body.array import Array
from ahmss.body.components import Quaternion, Vector, multiply, rotate
from ahmss.body.links import INDEX, PARENTS
from ahmss.body.skeleton import Skeleton
from ahmss.database.records import Site

__all__ = ["Body", "Parts"]

_PALMS = {"right_palm": ("right_hand", 0), "left_palm": ("left_hand", 1)}  # links, and rows of a skeleton's grips
_EYES = "eyes"
_UP_IN_LINK = (np.sqrt(0.5), 0.0, np.sqrt(0.5), 0.0)  # turns x ahead and z up where a link has x up, -z ahead


@dataclass(frozen=True)
class Body:
    """A human's body: its skeleton, rotations (43, 4) and root (3,)."""

    skeleton: Skeleton
    rotations: Array
    root: Array

    @property
    def pose(self) -> list[float]:
        """The same in one row of 175: root, then rotations."""
        return [*self.root.tolist(), *self.rotations.ravel().tolist()]


@dataclass(frozen=True)
class _Plan:
    """The links to be computed, parents first, and the sites on them.

    chain: (where its rotation begins in a pose, place of its parent in the chain, offset). sites: (place in the chain,
    position, rotation) in a link.
    """

    chain: tuple[tuple[int, int, Vector], ...]
    sites: tuple[tuple[int, Vector, Quaternion], ...]


class Parts:
    """Sites that belong to parts of bodies; `of` says where one human has them.

    A palm's frame is the grip's. The eyes' and each link's x points along the link, the eyes' ahead with z up.
    """

    def __init__(self, sites: Iterable[Site]) -> None:
        self._sites = tuple((site.part, site.position, site.rotation) for site in sites)
        self._plans: dict[Skeleton, _Plan] = {}

    def of(self, skeleton: Skeleton, pose: Sequence[float]) -> list[list[float]]:
        """Place and rotation (7) in the world of each, of who is in that pose.

        Args:
            skeleton: the human's measures. pose: 175 numbers, as the world has them: root, then rotations of links.
        """
        plan = self._plans.get(skeleton)
        if plan is None:
            plan = self._plans[skeleton] = _plan(skeleton, self._sites)
        numbers: Any = pose
        places: list[Vector] = [tuple(numbers[:3])]
        world: list[Quaternion] = [numbers[3:7]]
        for row, parent, offset in plan.chain:
            (x0, y0, z0), q = places[parent], world[parent]
            x, y, z = rotate(q, offset)
            places.append((x0 + x, y0 + y, z0 + z))
            world.append(multiply(q, numbers[row : row + 4]))
        out: list[list[float]] = []
        for at, position, rotation in plan.sites:
            (x0, y0, z0), q = places[at], world[at]
            x, y, z = rotate(q, position)
            out.append([x0 + x, y0 + y, z0 + z, *multiply(q, rotation)])
        return out


@lru_cache(maxsize=256)
def _plan(skeleton: Skeleton, sites: tuple[tuple[str, Vector, Quaternion], ...]) -> _Plan:
    frames = [_frame(skeleton, part) for part, _, _ in sites]
    order = [0, *sorted({link for last, _, _ in frames for link in _up_to_the_hips(last)})]  # parents come first
    at = {link: number for number, link in enumerate(order)}
    chain = [(3 + 4 * link, at[PARENTS[link]], tuple(skeleton.offsets[link].tolist())) for link in order[1:]]
    placed: list[tuple[int, Vector, Quaternion]] = []
    for (link, (x0, y0, z0), turned), (_, position, rotation) in zip(frames, sites, strict=True):
        x, y, z = rotate(turned, position)
        placed.append((at[link], (x0 + x, y0 + y, z0 + z), multiply(turned, rotation)))
    return _Plan(tuple(chain), tuple(placed))


def _frame(skeleton: Skeleton, part: str) -> tuple[int, Vector, Quaternion]:
    """The link that a part of the body is on, and the part's place and rotation in its frame."""
    if part in _PALMS:
        hand, row = _PALMS[part]
        grip = skeleton.grips[row].tolist()
        return INDEX[hand], tuple(grip[:3]), tuple(grip[3:])
    if part == _EYES:
        return INDEX["head"], tuple(skeleton.eye.tolist()), _UP_IN_LINK
    return INDEX[part], (0.0, 0.0, 0.0), (1.0, 0.0, 0.0, 0.0)


def _up_to_the_hips(link: int) -> list[int]:
    """A link and those above it, the hips left out."""
    links: list[int] = []
    while link > 0:
        links.append(link)
        link = PARENTS[link]
    return links
