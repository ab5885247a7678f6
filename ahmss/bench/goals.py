"""The numbers to reach, and what the thesis measured in 2000 (tables 5.5, 5.6 and 5.8)."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

__all__ = ["GOALS", "Goal", "look_up"]


@dataclass(frozen=True)
class Goal:
    """One number: where it stands in the report, what it is, its unit, the thesis's figure, the bound to reach."""

    key: str
    what: str
    unit: str
    thesis: str
    bound: float
    least: bool  # whether the bound is the least that is good enough, else the most

    def met(self, value: float) -> bool:
        """Whether a measured value reaches the bound."""
        return value >= self.bound if self.least else value <= self.bound

    @property
    def reach(self) -> str:
        """The bound in words."""
        return f"{'≥' if self.least else '≤'} {self.bound:,g}"


GOALS = (
    Goal("start_ms.python", "start of a Python algorithm to its first frame", "ms", "5.2-6.8", 1.0, least=False),
    Goal("start_ms.native", "the same of a native executable", "ms", "5.2-6.8", 1.0, least=False),
    Goal("start_ms.walk", "start of a walk, 3.8 m round the things of a room", "ms", "5.3", 8.3, least=False),
    Goal("start_ms.walk_100m", "start of a walk of 100 m", "ms", "5.3", 8.3, least=False),
    Goal("compute_fps.playback", "frames computed: playback of a clip", "/s", "24.98", 4000, least=True),
    Goal("compute_fps.slerp", "slerp", "/s", "24.97", 4000, least=True),
    Goal("compute_fps.fusion", "two fused motions", "/s", "24.89", 2000, least=True),
    Goal("compute_fps.object", "a motion and an object", "/s", "12.48", 2000, least=True),
    Goal("compute_fps.fusion_object", "two fused motions and an object", "/s", "12.51", 2000, least=True),
    Goal("compute_fps.walk", "a walk", "/s", "24.93", 4000, least=True),
    Goal("compute_fps.walk_fusion", "a walk and slerp, fused", "/s", "24.89", 2000, least=True),
    Goal("compute_fps.walk_object", "a walk and an object", "/s", "12.48", 2000, least=True),
    Goal("compute_fps.walk_fusion_object", "a walk and slerp, fused, and an object", "/s", "12.51", 2000, least=True),
    Goal("display_fps.640x480", "pictures shown, 640x480", "/s", "4.96", 40, least=True),
    Goal("display_fps.1280x720", "pictures shown, 1280x720", "/s", "4.96", 25, least=True),
    Goal("display_fps_live.640x480", "the same while the scenario runs, 640x480", "/s", "4.96", 40, least=True),
    Goal("display_fps_live.1280x720", "the same while the scenario runs, 1280x720", "/s", "4.96", 25, least=True),
    Goal("server.humans", "humans at 60 Hz on one core, p99 under a frame", "", "1", 1000, least=True),
    Goal("latency_ms.p99", "pose sent to world seen, 100 humans, p99", "ms", "about 200", 5.0, least=False),
    Goal("body_us_per_human", "blend of 4 and forward kinematics, of 1,000", "µs", "-", 2.0, least=False),
    Goal("lookup_us.10", "an action found and asked whether it may be done, 10 objects", "µs", "-", 1600, least=False),
    Goal("lookup_us.10000", "the same among 10,000 objects", "µs", "-", 1600, least=False),
    Goal("memory_mb.buttons_10000", "a main's memory of 10,000 push buttons", "MB", "-", 50, least=False),
)


def look_up(report: Mapping[str, Any], key: str) -> float | None:
    """The number under a dotted key, or None where it was not measured."""
    value: Any = report
    for part in key.split("."):
        if not isinstance(value, Mapping) or part not in value:
            return None
        value = value[part]
    return None if value is None else float(value)
