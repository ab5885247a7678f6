"""The plot of how the cost grows: every curve in it, and no label in another one's place."""

from __future__ import annotations

from itertools import pairwise
from pathlib import Path
from typing import Any

import pytest
from PIL import Image

from ahmss.bench.scale import draw

REPORT = {
    "humans": [(1, 900.0), (30, 1300.0), (1000, 29000.0)],
    "fused": [(1, 500.0), (8, 1250.0), (32, 4000.0)],
    "objects": [(10, 430.0), (1000, 630.0), (10_000, 620.0)],
    "polygons": [(24_000, 21.0), (35_000, 28.0), (57_000, 42.0), (103_000, 67.0), (190_000, 118.0)],
}


def test_the_labels_of_an_axis_stand_beside_each_other(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    pyplot: Any = pytest.importorskip("matplotlib.pyplot")  # here, for it takes most of a second of each worker
    figures: list[Any] = []
    monkeypatch.setattr(pyplot, "close", figures.append)
    draw(REPORT, tmp_path / "plots" / "scale.png")
    with Image.open(tmp_path / "plots" / "scale.png") as picture:
        assert picture.size == (1000, 700)
    (figure,) = figures
    for axis, points in zip(figure.axes, REPORT.values(), strict=True):
        assert [label.get_text() for label in axis.get_xticklabels()] == [f"{x:,}" for x, _ in points]
        boxes = [label.get_window_extent() for label in axis.get_xticklabels()]
        assert all(left.x1 < right.x0 for left, right in pairwise(boxes))
        assert not [label for label in axis.get_xticklabels(minor=True) if label.get_text()]
    monkeypatch.undo()
    pyplot.close(figure)
