"""The two humans that are shipped."""

from __future__ import annotations

import numpy as np

from ahmss.body.skeleton import Skeleton
from humans.figure import Figure

__all__ = ["PEOPLE", "aiko", "ken"]


def aiko() -> Figure:
    """A woman of 1.62 m: dark hair tied back, coral shirt with short sleeves, slate trousers, white shoes."""
    # Height, half width, front, back, all in percent of stature.
    trunk = np.array([
        (46.6, 4.0, 1.6, 3.4), (47.6, 7.0, 3.6, 5.0), (49.0, 9.2, 4.9, 6.2), (50.0, 9.9, 5.3, 6.6),
        (53.0, 9.9, 5.7, 6.4), (57.0, 9.1, 5.6, 5.2), (61.0, 7.6, 5.0, 4.3),
        (63.0, 7.35, 4.9, 4.3), (66.0, 7.6, 5.1, 4.8),
        (70.0, 8.2, 5.3, 5.6),
        (74.0, 8.7, 5.3, 6.1), (77.0, 8.8, 4.9, 6.2), (80.0, 8.0, 4.3, 5.6),
        (82.5, 5.6, 3.5, 4.8), (84.5, 3.6, 2.2, 4.0),
    ])  # fmt: skip
    return Figure(
        skeleton=Skeleton.of(1.62, "female", "aiko"), trunk=trunk / 100.0, limb=0.86, neck=(0.042, 0.047),
        colours={
            "skin": (238, 196, 168), "lips": (214, 122, 114), "mouth": (150, 74, 70), "hair": (74, 52, 46),
            "brow": (88, 62, 54), "lash": (44, 30, 32), "blush": (232, 132, 118), "rim": (206, 150, 134),
            "white": (246, 246, 244), "iris": (92, 58, 38),
            "pupil": (16, 12, 12), "glint": (255, 255, 255), "shirt": (226, 104, 82), "collar": (240, 232, 220),
            "trousers": (58, 68, 86), "belt": (42, 40, 44), "shoe": (236, 236, 232), "sole": (190, 190, 186),
            "nail": (240, 188, 176), "band": (226, 104, 82), "button": (150, 138, 128), "badge": (250, 244, 236),
        },
        long_sleeves=False, sentence="A woman of 1.62 m in a coral shirt.",
    )  # fmt: skip


def ken() -> Figure:
    """A man of 1.76 m: short hair, blue overalls with a belt, brown boots."""
    trunk = np.array([
        (46.6, 4.0, 1.8, 3.2), (47.6, 6.8, 3.8, 4.8), (49.0, 8.8, 5.0, 5.8), (50.0, 9.5, 5.3, 6.2),
        (53.0, 9.6, 5.6, 6.1), (57.0, 9.1, 5.6, 5.6), (61.0, 8.6, 5.5, 5.1),
        (65.0, 8.8, 5.6, 5.1), (70.0, 9.5, 6.0, 6.0), (74.0, 10.1, 6.1, 6.6),
        (77.0, 10.2, 5.8, 6.6), (80.0, 9.2, 5.0, 6.0), (82.5, 6.6, 4.0, 5.2), (84.5, 4.2, 2.6, 4.4),
    ])  # fmt: skip
    return Figure(
        skeleton=Skeleton.of(1.76, "male", "ken"), trunk=trunk / 100.0, limb=0.95, neck=(0.054, 0.061),
        colours={
            "skin": (222, 172, 140), "lips": (196, 130, 110), "mouth": (120, 64, 56), "hair": (62, 46, 38),
            "brow": (50, 36, 30), "lash": (50, 36, 32), "blush": (206, 124, 98), "rim": (186, 130, 108),
            "white": (244, 244, 242), "iris": (70, 52, 40),
            "pupil": (16, 12, 12), "glint": (255, 255, 255), "shirt": (62, 98, 148), "collar": (52, 84, 130),
            "trousers": (62, 98, 148), "belt": (52, 42, 36), "shoe": (104, 68, 44), "sole": (48, 42, 40),
            "nail": (228, 178, 156), "band": (236, 200, 78), "trim": (40, 62, 98), "badge": (240, 238, 230),
        },
        long_sleeves=True, sentence="A man of 1.76 m in blue overalls.",
    )  # fmt: skip


PEOPLE = {"aiko": aiko, "ken": ken}
