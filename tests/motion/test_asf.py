"""AMC with its ASF: bones turned in axes of their own, and damage named with file and line."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from ahmss.body.quaternion import to_matrix
from ahmss.errors import DataError
from ahmss.motion.asf import CMU_RATE, read_amc

ASF = """# made by hand
:version 1.10
:units
  mass 1.0
  length 0.45
  angle deg
:root
  order TX TY TZ RX RY RZ
  axis XYZ
  position 0 0 0
  orientation 0 0 0
:bonedata
  begin
    id 1
    name lfemur
    direction 0 -1 0
    length 7
    axis 10 20 30 XYZ
    dof rx ry rz
    limits (-160.0 20.0)
           (-70.0 70.0)
           (-60.0 70.0)
  end
  begin
    id 2
    name ltibia
    direction 0 -1 0
    length 6
    axis 0 0 90 XYZ
    dof rx
  end
:hierarchy
  begin
    root lfemur
    lfemur ltibia
  end
"""
AMC = """# made by hand
:FULLY-SPECIFIED
:DEGREES
1
root 1 2 3 0 0 0
lfemur 0 0 0
ltibia 0
2
root 1 2 4 10 20 30
lfemur 40 50 60
ltibia 90
"""


def written(tmp_path, asf=ASF, amc=AMC, name="07_01.amc"):
    (tmp_path / "07.asf").write_text(asf)
    (tmp_path / name).write_text(amc)
    return tmp_path / name


def test_bones_become_joints_at_their_beginnings(tmp_path):
    source = read_amc(written(tmp_path))
    assert source.names == ("root", "lfemur", "ltibia", "ltibia_end")
    assert source.parents == (-1, 0, 1, 2)
    assert source.rate == CMU_RATE
    places, _ = source.world()
    np.testing.assert_allclose(places[0], [[1, 2, 3], [1, 2, 3], [1, -5, 3], [1, -11, 3]], atol=1e-12)


def test_a_bone_turns_in_its_own_axes(tmp_path):
    source = read_amc(written(tmp_path))
    axes = Rotation.from_euler("xyz", [10, 20, 30], degrees=True)  # about axes that stay: x, then y, then z
    turned = Rotation.from_euler("xyz", [40, 50, 60], degrees=True)
    np.testing.assert_allclose(to_matrix(source.rotations[1, 1]), (axes * turned * axes.inv()).as_matrix(), atol=1e-12)
    root = Rotation.from_euler("xyz", [10, 20, 30], degrees=True)
    np.testing.assert_allclose(to_matrix(source.rotations[1, 0]), root.as_matrix(), atol=1e-12)
    # The shin's x axis lies along the world's y: bending it by 90 degrees turns it about y.
    np.testing.assert_allclose(source.rotations[1, 2], [np.sqrt(0.5), 0.0, np.sqrt(0.5), 0.0], atol=1e-12)


def test_radians_are_understood(tmp_path):
    degrees = read_amc(written(tmp_path))
    amc = AMC.replace(":DEGREES", ":RADIANS").replace("10 20 30", "0.17453293 0.34906585 0.52359878")
    amc = amc.replace("40 50 60", "0.6981317 0.87266463 1.04719755").replace("ltibia 90", "ltibia 1.57079633")
    np.testing.assert_allclose(read_amc(written(tmp_path, amc=amc)).rotations, degrees.rotations, atol=1e-7)


def test_the_only_skeleton_of_a_folder_serves(tmp_path):
    assert read_amc(written(tmp_path, name="walk.amc")).frames == 2
    (tmp_path / "08.asf").write_text(ASF)
    with pytest.raises(DataError, match=r"its skeleton is missing: put walk\.asf beside it"):
        read_amc(tmp_path / "walk.amc")


DAMAGE = {
    "unknown bone": ("amc", "ltibia 90", "rtibia 90", '07_01.amc: line 11: no bone "rtibia" in the skeleton'),
    "too few numbers": ("amc", "40 50 60", "40 50", "07_01.amc: line 10: lfemur has 2 numbers; its skeleton has 3"),
    "no number": ("amc", "ltibia 90", "ltibia x", '07_01.amc: line 11: "x" is not a number'),
    "not finite": ("amc", "ltibia 90", "ltibia nan", '07_01.amc: line 11: "nan" is not a finite number'),
    "cut": ("amc", "lfemur 40 50 60\nltibia 90\n", "", "07_01.amc: line 9: frame 2 ends without lfemur, ltibia"),
    "no frame": ("amc", AMC[AMC.index("1\n") :], "", "07_01.amc: line 3: there is no frame"),
    "no frame number": ("amc", "\n1\n", "\n", '"root" stands before the number of the first frame'),
    "bone without length": ("asf", "    length 7\n", "", "07.asf: line 13: this bone has no length"),
    "no direction": ("asf", "direction 0 -1 0", "direction 0 -1", "07.asf: line 13: direction or dof of bone lfemur"),
    "axis of two": ("asf", "axis 0 0 90 XYZ", "axis 0 0 XYZ", "07.asf: line "),
    "undescribed": ("asf", "lfemur ltibia", "lfemur rtibia", '07.asf: line 35: no bone "rtibia" has been described'),
    "hangs on nothing": ("asf", "    lfemur ltibia\n", "", "07.asf: :hierarchy: ltibia hang on nothing"),
    "skeleton cut": ("asf", ASF[ASF.index(":hierarchy") :], "", "is the file cut short?"),
    "bone cut": ("asf", ASF[ASF.index("    axis 0 0 90") :], "", "07.asf: line 28: the file ends where end of a bone"),
}


@pytest.mark.parametrize(("file", "old", "new", "message"), DAMAGE.values(), ids=DAMAGE)
def test_damage_is_one_sentence_with_file_and_line(tmp_path, file, old, new, message):
    texts = {"asf": ASF, "amc": AMC}
    assert old in texts[file]
    texts[file] = texts[file].replace(old, new, 1)
    with pytest.raises(DataError) as error:
        read_amc(written(tmp_path, **texts))
    assert message in str(error.value)
    assert "\n" not in str(error.value)
