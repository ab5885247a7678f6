"""What lies low on a table is taken without a hand in the table."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import trimesh
from msgspec.structs import replace

from ahmss.algorithm import Transform
from ahmss.algorithm.messages import ObjectRecord, PoseRecord, ShapeRecord, SiteRecord, Start
from ahmss.body.array import Array
from ahmss.body.links import INDEX, LINKS, fingers
from ahmss.body.quaternion import from_axis_angle
from ahmss.database import Workspace
from ahmss.errors import AlgorithmError
from tests.grasping.shapes import PLATE, lathe, mug, outside

from .reached import outlined
from .scene import Body, record
from .test_before_grip import DEEPEST, LOOSELY, UP, seen, skin

TOP, TABLE = 0.88, record("room/table")
LOW = mug(0.03, 0.05) * np.array([1.0, 1.0, 0.62])  # its handle's middle 3 cm over what it stands on
HANDLE = SiteRecord((0.0785, 0.0, 0.03), (0.0, 0.0, 0.0, 1.0), "", "power")
EDGE = SiteRecord((0.0, 0.0, 0.012), (1.0, 0.0, 0.0, 0.0), "", "precision")


def before(folder: Path, triangles: Array, site: SiteRecord, turn: float, aside: float = 0.0) -> tuple[Body, Start]:
    """ken at the table, which something stands on, and a reach for its site with the right hand."""
    home = folder / "objectdb" / "thing"
    home.mkdir(parents=True)
    corners = triangles.reshape(-1, 3)
    trimesh.Trimesh(corners, np.arange(len(corners)).reshape(-1, 3), process=False).export(home / "it.stl")
    (home / "object.toml").write_text('name = "thing"\nshape = "it.stl"\nunit = "m"\n')
    kept = Workspace(folder).objects.kept_shape("thing")
    assert kept is not None
    edge = TABLE.place[0] - 0.5  # of the table's top, before which one stands
    at = Transform(np.array([edge + 0.11 + aside, -0.15, TOP]), from_axis_angle(UP, np.array(np.radians(turn))))
    body = Body("ken", x=edge - 0.33, y=-0.15, facing=0.0)
    thing = ObjectRecord(
        5, "thing", "thing", tuple(at.place.tolist()), tuple(at.rotation.tolist()), {"there": site}, {}, {},
        shape=ShapeRecord(str(kept[0]), kept[1]),
    )  # fmt: skip
    start = Start(
        kind="human", human=body.skeleton.to_record(), pose=PoseRecord.of(body.rotations, body.root), frames=0,
        object=thing, site="there", hand="right", world=[outlined(TABLE, 11)],
    )  # fmt: skip
    return body, start


def test_a_hand_at_a_low_handle_stays_out_of_the_table(tmp_path: Path) -> None:
    body, start = before(tmp_path, LOW, HANDLE, -90.0)
    shown = body.do("reach", start)
    shown += body.do("grasp", replace(start, pose=PoseRecord.of(body.rotations, body.root), frames=30))
    of = skin("ken")
    chosen: Any = np.flatnonzero(np.isin(of.link, [INDEX["right_hand"], *fingers("right")]))
    edge = TABLE.place[0] - 0.5
    for pose in shown[-36:]:
        points = of.posed(pose.rotations, pose.root, chosen)
        over = points[points[:, 0] > edge]
        assert over[:, 2].min() > TOP - DEEPEST
    assert start.object is not None
    frame = Transform(np.array(start.object.place), np.array(start.object.rotation))
    gaps = outside(seen(of, shown[-1], frame, chosen), LOW, LOOSELY)
    assert gaps.min() > -DEEPEST
    assert len({LINKS[link].split("_")[1] for link in of.link[chosen[gaps < LOOSELY]].tolist()} - {"hand"}) >= 3


def test_a_plate_that_lies_flat_is_refused_and_one_over_the_edge_is_taken(tmp_path: Path) -> None:
    body, start = before(tmp_path / "flat", lathe(PLATE), EDGE, 0.0, 0.1)
    with pytest.raises(
        AlgorithmError, match="what it stands on or beside is in the way; put it where its edge is free"
    ):
        body.do("reach", start)
    body, start = before(tmp_path / "over", lathe(PLATE), EDGE, 0.0, -0.08)
    body.do("reach", start)
    body.do("grasp", replace(start, pose=PoseRecord.of(body.rotations, body.root), frames=30))
