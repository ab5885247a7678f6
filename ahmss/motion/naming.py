"""Which joint of a file is which part of a body: by its name, in the vocabularies that motion files commonly use.

A name is cut into words (`mixamorig:LeftUpLeg`: left, up, leg), the side is taken out, and what is left is looked up.
Only limbs, hips and head are known by name; the joints of the trunk are those on the way between them.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass

from ahmss.errors import DataError
from ahmss.motion.source import SourceMotion

__all__ = ["SIDES", "Parts", "parts_of"]

SIDES = ("right", "left")

# Each part's names without the side, the best first: where a file has both an ankle and a foot, the foot is the toes'.
_LIMBS: dict[str, tuple[str, ...]] = {
    "upper_leg": ("upleg", "upperleg", "thigh", "femur", "hip"),
    "lower_leg": ("leg", "lowerleg", "lowleg", "shin", "calf", "knee", "tibia"),
    "foot": ("ankle", "foot"),
    "toe": ("toebase", "toes", "toe", "toe0", "ball", "foot"),
    "upper_arm": ("arm", "upperarm", "uparm", "humerus", "shldr", "shoulder"),
    "lower_arm": ("forearm", "lowerarm", "lowarm", "loarm", "elbow", "radius"),
    "hand": ("wrist", "hand"),
    "palm": ("hand",),
}
_LISTED = 16  # joints that an error names
_OPTIONAL = ("toe", "palm")
_HIPS = ("hips", "hip", "pelvis", "root")
_HEAD = ("head",)
_PREFIXES = {"bip", "bip01", "bip001", "j", "c", "b", "def", "joint", "character1", "skel", "rig", "m", "avg"}
_SIDES = {"l": "left", "left": "left", "r": "right", "right": "right"}
_FAMILIES = (  # joints that only this family has, as words
    ("Mixamo", ("mixamorig",)),
    ("ACCAD", ("tospine",)),
    ("CMU", ("lhipjoint", "lowerback")),
    ("Bandai Namco", ("jointroot", "upperlegl")),
    ("3ds Max Biped", ("bip01pelvis",)),
    ("Poser or DAZ", ("lshldr",)),
    ("LAFAN1", ("lefttoe", "leftupleg", "spine2")),
    ("SMPL", ("lankle", "lcollar")),
    ("Unreal", ("thighl", "spine01")),
)


@dataclass(frozen=True)
class Parts:
    """Indices of a file's joints.

    spine: from above the hips up to the joint below the neck, at least one; chest: the one that bears the arms; neck:
    the first joint above the chest, not in the same place. limbs: by "right_upper_arm" and the like; "right_toe" and
    "right_palm" only where the file has them. tips: what a limb's last joint points to. unknown: names of joints that
    play no part, such as fingers.
    """

    hips: int
    spine: tuple[int, ...]
    chest: int
    neck: int
    head: int
    limbs: dict[str, int]
    tips: dict[str, int]
    family: str
    unknown: tuple[str, ...]


def parts_of(source: SourceMotion) -> Parts:
    """The parts of a body among a file's joints.

    Raises:
        DataError: some part has no joint by any known name; names the part and the joints that there are.
    """
    names = [_words(name) for name in source.names]
    limbs: dict[str, int] = {}
    for side in SIDES:
        for part, known in _LIMBS.items():
            found = _find(names, side, known, taken=limbs)
            if found >= 0:
                limbs[f"{side}_{part}"] = found
    hips, head = _find(names, "", _HIPS, taken={}), _find(names, "", _HEAD, taken={})
    missing = [name for name, joint in (("hips", hips), ("head", head)) if joint < 0]
    missing += [f"{s}_{p}" for s in SIDES for p in _LIMBS if p not in _OPTIONAL and f"{s}_{p}" not in limbs]
    if missing:
        known = {hips, head, *limbs.values()}
        left = [name for i, name in enumerate(source.names) if i not in known and not name.endswith("_end")]
        others = ", ".join(left[:_LISTED]) + (", ..." if len(left) > _LISTED else "")
        raise DataError(source.file, "joints", f"none is known to be {', '.join(missing)}; the others are: {others}")
    return _with_trunk(source, hips, head, limbs)


def _with_trunk(source: SourceMotion, hips: int, head: int, limbs: dict[str, int]) -> Parts:
    """The parts, those of the trunk by what hangs on what."""
    up = _ancestors(source.parents, head)
    arms = [_ancestors(source.parents, limbs[f"{side}_upper_arm"]) for side in SIDES]
    shared = [joint for joint in up if joint in arms[0] and joint in arms[1]]
    if hips not in up or not shared or shared[0] == hips or head == shared[0]:
        raise DataError(
            source.file, "joints", "the head and both arms must hang on one joint of the trunk above the hips"
        )
    chest = shared[0]
    chain = (head, *up)
    above = chain[: chain.index(chest)]
    neck = next((joint for joint in reversed(above) if source.offsets[joint].any()), head)
    spine = tuple(reversed(up[up.index(chest) : up.index(hips)]))
    tips = {name: tip for name, joint in limbs.items() if (tip := _tip(source, joint, limbs)) >= 0}
    used = {hips, head, neck, *spine, *limbs.values(), *tips.values()}
    used |= {joint for part in list(used) for joint in _ancestors(source.parents, part)}
    unknown = tuple(name for i, name in enumerate(source.names) if i not in used and not name.endswith("_end"))
    return Parts(hips, spine, chest, neck, head, limbs, tips, _family(source.names), unknown)


def _words(name: str) -> tuple[str, str]:
    """The side ("" for none) and the rest of a joint's name in lower case, without what stands before all names."""
    name = name.rsplit(":", 1)[-1]
    words = [word.lower() for word in re.findall(r"[A-Z]+(?![a-z])|[A-Z]?[a-z]+\d*|\d+", name)]
    while len(words) > 1 and words[0] in _PREFIXES:
        words = words[1:]
    for end in (0, -1):
        if len(words) > 1 and words[end] in _SIDES:
            return _SIDES[words.pop(end)], "".join(words)
    whole = "".join(words)
    known = {word for names in _LIMBS.values() for word in names}
    if whole[:1] in ("l", "r") and whole[1:] in known and whole not in known:  # lfemur, as ASF has it
        return _SIDES[whole[0]], whole[1:]
    return "", whole


def _find(names: list[tuple[str, str]], side: str, known: Sequence[str], taken: dict[str, int]) -> int:
    """The joint of that side with the best known name that no other part has; -1 for none."""
    for name in known:
        for joint, words in enumerate(names):
            if words == (side, name) and joint not in taken.values():
                return joint
    return -1


def _ancestors(parents: tuple[int, ...], joint: int) -> list[int]:
    """The joints that a joint hangs on, nearest first."""
    out: list[int] = []
    while (joint := parents[joint]) >= 0:
        out.append(joint)
    return out


def _tip(source: SourceMotion, joint: int, limbs: dict[str, int]) -> int:
    """What a limb's last joint points to: the middle finger, or the child that is farthest away; -1 for none."""
    children = [i for i, parent in enumerate(source.parents) if parent == joint and i not in limbs.values()]
    lengths = [float(source.offsets[i] @ source.offsets[i]) for i in children]
    if not children or max(lengths) == 0.0:
        return -1
    middle = [i for i in children if "middle" in source.names[i].lower()]
    return middle[0] if middle else children[lengths.index(max(lengths))]


def _family(names: Sequence[str]) -> str:
    """The vocabulary's name, for people; "common" where several share it."""
    joined = {re.sub(r"[^a-z0-9]", "", name.lower()) for name in names} | {name.split(":")[0].lower() for name in names}
    return next((family for family, marks in _FAMILIES if joined.issuperset(marks)), "common")
