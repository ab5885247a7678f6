"""Who walks to somebody keeps both hands, the empty and the full one, out of what stands by the way."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from ahmss.database import Workspace
from ahmss.reaching.prism import clearance
from ahmss.reaching.reacher import Reacher
from ahmss.reaching.skin import arm_skin
from tests.algorithms.devices import at, device
from tests.algorithms.reached import prisms
from tests.demo.recorded import Recorded
from tests.people.test_handing import ROOT, play

ALONG_A_TABLE = """
add floor
add table at 0 0 0
add cup at -0.3 0 0.88
human ken body ken at -1.2 0.2 facing 0
human aiko body aiko at -1.0 -1.8 facing 90
ken: do floor walk to cup
ken: do cup grasp
ken: do cup lift
sync
aiko: do ken receive
ken: do aiko hand_over
"""


def test_who_brings_something_keeps_the_empty_hand_out_of_the_table_that_it_stood_on(tmp_path: Path) -> None:
    """It hung through the edge, by up to 93 mm in what the table, told as a block, takes up."""
    recording, mains = play(tmp_path, ALONG_A_TABLE)
    assert [main["messages"] for main in mains] == [[], []]
    ken, skeleton = Recorded.read(recording, "ken", ("cup",)), Workspace(ROOT).humans.get("ken").skeleton
    table = prisms(device("table", at(0.0, 0.0, 0.0)))
    gives = slice(ken.holders["cup"].index("ken") + 60, ken.holders["cup"].index("aiko"))
    points, radii = arm_skin(Reacher.of(skeleton, "left"), ken.rotations[gives], ken.root[gives])
    assert float((clearance(table, np.asarray(points)) - radii).min()) > -0.01
