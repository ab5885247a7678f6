"""The 43 links of the human model: 15 of the body, 14 of each hand's fingers (Ichiguchi 2000, figures 4.1 to 4.3).

The order is the same everywhere: in poses, clips, messages and skins. Parents stand before their children.
Names are those of the VRM humanoid in snake case.
"""

from __future__ import annotations

__all__ = ["CHILDREN", "INDEX", "LINKS", "PARENTS", "fingers", "side_of"]

_FINGERS = (
    ("thumb", ("proximal", "distal")),
    ("index", ("proximal", "intermediate", "distal")),
    ("middle", ("proximal", "intermediate", "distal")),
    ("ring", ("proximal", "intermediate", "distal")),
    ("little", ("proximal", "intermediate", "distal")),
)


def _tree() -> dict[str, str | None]:
    """Each link's parent, in the one order."""
    tree: dict[str, str | None] = {"hips": None, "spine": "hips", "head": "spine"}
    for side in ("right", "left"):
        tree[f"{side}_upper_arm"] = "spine"
        tree[f"{side}_lower_arm"] = f"{side}_upper_arm"
        tree[f"{side}_hand"] = f"{side}_lower_arm"
        tree[f"{side}_upper_leg"] = "hips"
        tree[f"{side}_lower_leg"] = f"{side}_upper_leg"
        tree[f"{side}_foot"] = f"{side}_lower_leg"
    for side in ("right", "left"):
        for finger, segments in _FINGERS:
            parent = f"{side}_hand"
            for segment in segments:
                tree[f"{side}_{finger}_{segment}"] = parent
                parent = f"{side}_{finger}_{segment}"
    return tree


_TREE = _tree()

LINKS: tuple[str, ...] = tuple(_TREE)
INDEX: dict[str, int] = {name: i for i, name in enumerate(LINKS)}
PARENTS: tuple[int, ...] = tuple(-1 if parent is None else INDEX[parent] for parent in _TREE.values())
CHILDREN: tuple[tuple[int, ...], ...] = tuple(
    tuple(i for i, parent in enumerate(PARENTS) if parent == link) for link in range(len(LINKS))
)


def fingers(side: str) -> range:
    """The indices of the 14 finger links of a hand, thumb first ("right" or "left")."""
    first = INDEX[f"{side}_thumb_proximal"]
    return range(first, first + 14)


def side_of(link: int) -> str:
    """`"right"`, `"left"`, or `""` for a link of the middle."""
    name = LINKS[link]
    return next((side for side in ("right", "left") if name.startswith(side)), "")
