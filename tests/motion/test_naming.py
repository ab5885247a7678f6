"""Joints known by name, in the vocabularies of many makers; the trunk by what hangs on what."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from ahmss.errors import DataError
from ahmss.motion.naming import parts_of
from ahmss.motion.source import SourceMotion

LIMBS = (
    "right_upper_leg", "right_lower_leg", "right_foot", "right_toe",
    "right_upper_arm", "right_lower_arm", "right_hand",
    "left_upper_leg", "left_lower_leg", "left_foot", "left_toe",
    "left_upper_arm", "left_lower_arm", "left_hand",
)  # fmt: skip
# For each family: the hips, the spine up to the chest, neck and head, the clavicle, and what a side's limbs are called.
FAMILIES = {
    "ACCAD": ("Hips", "ToSpine Spine Spine1", "Neck Head", "{S}Shoulder",
              "{S}UpLeg {S}Leg {S}Foot {S}ToeBase {S}Arm {S}ForeArm {S}Hand", ("Right", "Left")),
    "CMU": ("Hips", "LowerBack Spine Spine1", "Neck Neck1 Head", "{S}Shoulder LHipJoint",
            "{S}UpLeg {S}Leg {S}Foot {S}ToeBase {S}Arm {S}ForeArm {S}Hand", ("Right", "Left")),
    "Mixamo": ("mixamorig:Hips", "mixamorig:Spine mixamorig:Spine1 mixamorig:Spine2", "mixamorig:Neck mixamorig:Head",
               "mixamorig:{S}Shoulder",
               "mixamorig:{S}UpLeg mixamorig:{S}Leg mixamorig:{S}Foot mixamorig:{S}ToeBase mixamorig:{S}Arm "
               "mixamorig:{S}ForeArm mixamorig:{S}Hand", ("Right", "Left")),
    "LAFAN1": ("Hips", "Spine Spine1 Spine2", "Neck Head", "{S}Shoulder",
               "{S}UpLeg {S}Leg {S}Foot {S}Toe {S}Arm {S}ForeArm {S}Hand", ("Right", "Left")),
    "Bandai Namco": ("joint_Root Hips", "Spine Chest", "Neck Head", "Shoulder_{S}",
                     "UpperLeg_{S} LowerLeg_{S} Foot_{S} Toes_{S} UpperArm_{S} LowerArm_{S} Hand_{S}", ("R", "L")),
    "3ds Max Biped": ("Bip01 Pelvis", "Bip01 Spine,Bip01 Spine1", "Bip01 Neck,Bip01 Head", "Bip01 {S} Clavicle",
                      "Bip01 {S} Thigh,Bip01 {S} Calf,Bip01 {S} Foot,Bip01 {S} Toe0,Bip01 {S} UpperArm,"
                      "Bip01 {S} Forearm,Bip01 {S} Hand", ("R", "L")),
    "Poser or DAZ": ("hip", "abdomen chest", "neck head", "{S}Collar",
                     "{S}Thigh {S}Shin {S}Foot {S}Toe {S}Shldr {S}ForeArm {S}Hand", ("r", "l")),
    "SMPL": ("Pelvis", "Spine1 Spine2 Spine3", "Neck Head", "{S}_Collar",
             "{S}_Hip {S}_Knee {S}_Ankle {S}_Foot {S}_Shoulder {S}_Elbow {S}_Wrist", ("R", "L")),
    "Unreal": ("pelvis", "spine_01 spine_02 spine_03", "neck_01 head", "clavicle_{S}",
               "thigh_{S} calf_{S} foot_{S} ball_{S} upperarm_{S} lowerarm_{S} hand_{S}", ("r", "l")),
    "common": ("Hips", "Chest Chest2", "Neck Head", "{S}Collar",
               "{S}Hip {S}Knee {S}Ankle {S}Toe {S}Shoulder {S}Elbow {S}Wrist", ("Right", "Left")),
}  # fmt: skip


def split(names: str) -> list[str]:
    """A list of joints; by commas where names have spaces."""
    return names.split(",") if "," in names or names.startswith("Bip01") else names.split()


def skeleton_of(family: str) -> SourceMotion:
    """A tree with the joints of a family; lengths don't matter."""
    hips, spine, head, clavicle, limbs, sides = FAMILIES[family]
    names: list[str] = []
    parents: list[int] = []

    def add(name: str, parent: int) -> int:
        names.append(name)
        parents.append(parent)
        return len(names) - 1

    def chain(joints: list[str], parent: int) -> int:
        for joint in joints:
            parent = add(joint, parent)
        return parent

    root = chain(split(hips), -1)
    chest = chain(split(spine), root)
    chain(split(head), chest)
    for side in sides:
        parts = [part.replace("{S}", side) for part in split(limbs)]
        chain(parts[:4], root)
        chain(parts[4:], chain(split(clavicle.replace("{S}", side))[:1], chest))
    if "LHipJoint" in clavicle:
        add("LHipJoint", root)
    count = len(names)
    rotations = np.tile([1.0, 0.0, 0.0, 0.0], (1, count, 1))
    offsets = np.ones((count, 3))
    return SourceMotion(Path("a.bvh"), "BVH", tuple(names), tuple(parents), offsets, rotations, offsets[None], 60.0)


@pytest.mark.parametrize("family", FAMILIES)
def test_every_part_is_found_in_every_family(family):
    source = skeleton_of(family)
    parts = parts_of(source)
    hips, spine, head, _, limbs, sides = FAMILIES[family]
    expected = [part.replace("{S}", side) for side in sides for part in split(limbs)]
    assert [source.names[parts.limbs[limb]] for limb in LIMBS] == expected
    assert source.names[parts.hips] == split(hips)[-1]
    assert [source.names[joint] for joint in parts.spine] == split(spine)
    assert source.names[parts.chest] == split(spine)[-1]
    assert source.names[parts.neck] == split(head)[0]
    assert source.names[parts.head] == split(head)[-1]
    assert parts.family == family


def test_a_part_without_a_known_name_is_said():
    source = skeleton_of("Mixamo")
    names = tuple(name.replace("LeftForeArm", "Tentacle") for name in source.names)
    said = r"a\.bvh: joints: none is known to be left_lower_arm; the others are: .*Tentacle"
    with pytest.raises(DataError, match=said):
        parts_of(SourceMotion(source.file, "BVH", names, *vars_of(source)))


def test_arms_that_hang_on_the_hips_are_refused():
    source = skeleton_of("common")
    parents = list(source.parents)
    parents[source.names.index("LeftCollar")] = 0
    broken = SourceMotion(source.file, "BVH", source.names, tuple(parents), *vars_of(source)[1:])
    with pytest.raises(DataError, match="one joint of the trunk above the hips"):
        parts_of(broken)


def vars_of(source: SourceMotion):
    return source.parents, source.offsets, source.rotations, source.translations, source.rate
