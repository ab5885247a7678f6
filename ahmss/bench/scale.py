"""`ahmss bench --scale`: how the cost of a frame grows with humans, fused motions, objects and polygons, as a plot."""

from __future__ import annotations

import tempfile
from pathlib import Path
from typing import Any

from rich.console import Console

from ahmss.bench.compute import rig
from ahmss.bench.display import drawn
from ahmss.bench.server_load import tick_cost_us
from ahmss.database.workspace import Workspace
from ahmss.errors import DependencyError

__all__ = ["draw", "scale"]

_HUMANS = (1, 3, 10, 30, 100, 300, 1000)
_FUSED = (1, 2, 4, 8, 16, 32)
_OBJECTS = (10, 100, 1000, 10_000)
_SHOWN = (1, 2, 4, 8, 16)

Points = list[tuple[float, float]]
_LABELS = {
    "humans": ("humans in the world", "server: a tick (µs)"),
    "fused": ("fused motions", "main: a frame (µs)"),
    "objects": ("objects in the world", "main: a frame (µs)"),
    "polygons": ("polygons shown", "viewer: a picture 640x480 (ms)"),
}
_progress = Console(stderr=True)


def scale(workspace: Workspace, picture: Path) -> dict[str, Points]:
    """Measure the four curves, (how many, cost), and draw them."""
    measured = {
        "humans": _humans(), "fused": _fused(workspace), "objects": _objects(workspace), "polygons": _polygons()
    }  # fmt: skip
    report = {name: [(x, round(y, 2)) for x, y in points] for name, points in measured.items()}
    draw(report, picture)
    _progress.print(f"wrote {picture}")
    return report


def _humans() -> Points:
    """What a tick costs the server with so many humans: a message of each in, a snapshot of all out."""
    _progress.print("measuring humans …")
    return [(n, tick_cost_us(n)) for n in _HUMANS]


def _fused(workspace: Workspace) -> Points:
    """What a frame costs a main that blends so many motions, each by a process of its own."""
    points: Points = []
    with rig(workspace) as one:
        for n in _FUSED:
            _progress.print(f"measuring {n} fused …")
            acts = ["thing playback frames {n}", *["other slerp frames {n}"] * (n - 1)]
            points.append((n, 1e6 / one.rate("do " + " with ".join(acts), frames=200, rounds=3)))
    return points


def _objects(workspace: Workspace) -> Points:
    """What a frame costs a main in a world of so many objects."""
    points: Points = []
    for n in _OBJECTS:
        _progress.print(f"measuring {n} objects …")
        with rig(workspace, objects=n) as one:
            points.append((n, 1e6 / one.rate("do thing playback frames {n}", frames=200, rounds=3)))
    return points


def _polygons() -> Points:
    """What a picture costs with so many humans in the room."""
    points: Points = []
    with tempfile.TemporaryDirectory(prefix="ahmss-bench-") as folder:
        script = Path(folder) / "crowd.txt"
        for n in _SHOWN:
            _progress.print(f"measuring the picture of {n} humans …")
            humans = [f"human h{i} body ken at {-0.7 * (i % 4)} {0.7 * (i // 4)}" for i in range(n)]
            script.write_text("\n".join(["add room", *humans, *(f"h{i}: wait 1" for i in range(n))]) + "\n")
            result = drawn(script, "640x480", 4.0)
            points.append((result["faces"], result["ms"]["p50"]))
    return points


def draw(report: dict[str, Points], picture: Path) -> None:
    """Draw the curves, each with its own axes.

    Raises:
        DependencyError: matplotlib is not installed.
    """
    try:
        import matplotlib as mpl
    except ImportError:
        raise DependencyError("the plot needs matplotlib; pip install 'ahmss[make]'") from None
    mpl.use("Agg")
    from matplotlib import pyplot
    from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter, NullLocator

    figure: Any
    figure, axes = pyplot.subplots(2, 2, figsize=(10, 7))
    plain = FuncFormatter(lambda value, _: f"{value:,.0f}")
    for axis, (name, points) in zip(axes.flat, report.items(), strict=True):
        counts, costs = [x for x, _ in points], [y for _, y in points]
        axis.plot(counts, costs, "o-", color="#2f6db3")
        across, up = _LABELS[name]
        axis.set(xscale="log", yscale="log", xlabel=across, ylabel=up, ylim=(min(costs) / 1.6, max(costs) * 1.6))
        axis.xaxis.set(minor_locator=NullLocator(), major_formatter=plain)
        axis.set_xticks(counts)
        axis.yaxis.set(major_locator=LogLocator(subs=(1, 2, 5)), major_formatter=plain, minor_formatter=NullFormatter())
        axis.grid(visible=True, which="both", alpha=0.25)
    figure.tight_layout()
    picture.parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(picture, dpi=100)
    pyplot.close(figure)
