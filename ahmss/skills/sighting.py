"""Where one looks who goes to a control: at it, while it is ahead."""

from __future__ import annotations

import numpy as np

from ahmss.algorithm.task import HumanTask
from ahmss.body.array import Array
from ahmss.body.inverse import GAZE
from ahmss.reaching.reacher import heading_of
from ahmss.skills.reaching import Looking

__all__ = ["Sighting"]

_SEES = np.radians(65.0)  # aside of where one goes, up to where one looks at it on the way
_NECK, _FORGETS = np.radians(75.0), 0.02  # aside; of looking: who looks no more may look to the other side next
_LONGEST = 2.0  # seconds that a gaze is on its way
_LAG = 0.07  # seconds of each of three lags by which the gaze turns then
_TARGETS = slice(220, 260)  # of a row


class Sighting:
    """The gaze of who goes to a control: on it while it is ahead."""

    def __init__(self, gaze: Looking, turned: float, rate: float) -> None:
        self._place, self._levels = gaze.place, [turned] * 3
        self._share = 1.0 - np.exp(-1.0 / (_LAG * rate))
        self._aside = 0.0

    def over(self, rows: Array) -> Array:
        """POSE rows (n, 260), the gaze added."""
        rows = rows.copy()
        targets = rows[:, _TARGETS].reshape(-1, 5, 8)
        for k, row in enumerate(rows):
            heading, aside, place = self._seen(row)
            wanted = float(abs(aside) < _SEES)
            for i, level in enumerate(self._levels):
                self._levels[i] = wanted = level + self._share * (wanted - level)
            self._aside = aside
            if abs(aside) > _NECK:  # a head turns no farther, and not from one shoulder to the other behind the back
                along = heading + np.clip(aside, -_NECK, _NECK)
                off = float(np.linalg.norm(place[:2] - row[1:3])) * np.array([np.cos(along), np.sin(along)])
                place = np.append(row[1:3] + off, place[2])
            targets[k, GAZE, :3], targets[k, GAZE, 7] = place, wanted
        rows[:, _TARGETS] = targets.reshape(-1, 40)
        return rows

    def _seen(self, row: Array) -> tuple[float, float, Array]:
        """Where one who is there (260,) faces, how far aside of that the place is, carried on while it is looked at."""
        heading, off = heading_of(row[4:176].reshape(43, 4), row[1:4]), self._place[:2] - row[1:3]
        aside = float(np.arctan2(off[1], off[0])) - heading
        about = self._aside if self._levels[-1] > _FORGETS else 0.0
        return heading, about + (aside - about + np.pi) % (2.0 * np.pi) - np.pi, self._place

    def goes_on(self, task: HumanTask) -> Looking:
        """The gaze of who has arrived, as far on its way as it is."""
        gaze = Looking(task, self._place)
        frames = np.arange(0.0, _LONGEST * task.rate)
        gaze.frames = int(np.searchsorted(gaze.turned(frames), min(self._levels[-1], 1.0 - 1e-6)))
        return gaze
