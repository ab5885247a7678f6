"""From markers on the skin to the 15 links: joint centres by regression, axes by what the markers span.

Marker sets: Plug-in Gait and CMU's 41, Helen Hayes with markers on the upper body, and the anatomical landmarks of the
ISB (Qualisys). Hip centres after Bell et al. (1990). Trunk and head have their neutral turn from the most upright
frames, as the markers' own planes are tilted by nobody knows how much.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ahmss.body.array import Array
from ahmss.body.links import INDEX
from ahmss.body.quaternion import align, between, conjugate, from_axis_angle, from_matrix, multiply, normalize, rotate
from ahmss.body.skeleton import UPRIGHT_WORLD
from ahmss.errors import DataError
from ahmss.motion.alignment import TRACKED, BodyMotion

__all__ = ["Markers", "body_of_markers"]

# Each role's markers in each vocabulary, S the side (L or R); of several in one entry the middle is taken.
_ROLES: dict[str, tuple[str, ...]] = {
    "front of the pelvis": ("SASI", "SFWT", "SASIS", "SIAS"),
    "knee": ("SKNE", "SKNEE", "SFLE"),
    "ankle": ("SANK", "SANKLE", "SFAL"),
    "toe": ("STOE", "STOES", "SFM1 SFM5", "SFM2"),
    "heel": ("SHEE", "SHEEL", "SHEL", "SFCC"),
    "shoulder": ("SSHO", "SSHOULDER", "SSAJ"),
    "elbow": ("SELB", "SELBOW", "SHLE"),
    "wrist": ("SWRA SWRB", "SRSP SUHE", "SWRI", "SWRIST"),
}
_OPTIONAL: dict[str, tuple[str, ...]] = {
    "inner knee": ("SKNM", "SKNEEMEDIAL", "SMKNE", "SFME"),
    "inner ankle": ("SANM", "SANKLEMEDIAL", "SMANK", "SMED", "STAM"),
    "thumb side": ("SWRA", "SRSP"),
    "little side": ("SWRB", "SUHE"),
    "knuckle": ("SFIN", "SHM2 SHM5", "SHAND"),
}
_MIDDLE: dict[str, tuple[str, ...]] = {
    "back of the pelvis": ("LPSI RPSI", "LBWT RBWT", "SACR", "VSACRAL", "LPSIS RPSIS", "LIPS RIPS", "SACRUM"),
    "neck": ("C7 CLAV", "CV7 SNJ", "C7", "CLAV", "LSHO RSHO", "LSHOULDER RSHOULDER", "LSAJ RSAJ"),
    "front of the head": ("LFHD RFHD", "FRONTHEAD", "LHDF RHDF"),
    "back of the head": ("LBHD RBHD", "REARHEAD", "LHDB RHDB"),
}
_HALF_KNEE, _HALF_ANKLE, _HALF_ELBOW, _ACROMION = 0.034, 0.023, 0.026, 0.02  # shares of stature, marker to joint
_WAIST = 0.060  # of stature, from the hips to our spine's joint (Drillis & Contini 1966)
_LEG = 0.491
_CERTAIN = (np.radians(12.0), np.radians(35.0))  # an elbow bent by less has no plane, by more has one
_DOWN, _X, _Y, _Z = np.array([0.0, 0.0, -1.0]), *np.eye(3)


@dataclass(frozen=True, eq=False)
class Markers:
    """Markers by name: places (F, N, 3) in metres, not a number where one was hidden; rate in frames a second."""

    file: Path
    names: tuple[str, ...]
    places: Array
    rate: float


def body_of_markers(markers: Markers) -> tuple[BodyMotion, list[str]]:
    """The motion of our links that markers show, and what there is to say of it.

    Raises:
        DataError: markers that are needed are missing, or nobody ever stands; names them.
    """
    found, report = _roles(markers)
    up = _up(found)
    lift = between(up, _Z)
    found = {role: rotate(lift, places) for role, places in found.items()}
    legs = [np.linalg.norm(found[f"{s} knee"] - found[f"{s} ankle"], axis=-1) for s in "RL"]
    stature = float(np.median(legs)) / (_LEG / 2.0)
    return _Body(found, stature, markers).motion(), report


def _roles(markers: Markers) -> tuple[dict[str, Array], list[str]]:
    """Places (F, 3) by role, gaps filled."""
    index = {re.sub(r"[^A-Z0-9]", "", name.rsplit(":", 1)[-1].upper()): i for i, name in enumerate(markers.names)}
    wanted = {f"{side} {role}": _sided(names, side) for side in "RL" for role, names in _ROLES.items()} | _MIDDLE
    helpful = {f"{side} {role}": _sided(names, side) for side in "RL" for role, names in _OPTIONAL.items()}
    seen: NDArray[np.bool_] = np.isfinite(markers.places).min(axis=-1)
    found: dict[str, Array] = {}
    missing: list[str] = []
    hidden = 0
    for role, choices in (wanted | helpful).items():
        rows = next((rows for choice in choices if (rows := _rows(index, choice, seen))), None)
        if rows is not None:
            found[role] = np.mean([_filled(markers.places[:, row]) for row in rows], axis=0)
            hidden = max(hidden, *(int((~seen[:, row]).sum()) for row in rows))
        elif role in wanted:
            missing.append(f"{role} ({' or '.join(choice.replace(' ', '+') for choice in choices[:2])})")
    if missing:
        raise DataError(markers.file, "markers", f"missing: {', '.join(missing)}")
    gaps = [f"hidden markers filled in, one for {hidden} of {len(seen)} frames"] if hidden else []
    return found, gaps


def _sided(names: tuple[str, ...], side: str) -> tuple[str, ...]:
    """Vocabulary entries with S, the side, put in."""
    return tuple(" ".join(side + word[1:] for word in name.split()) for name in names)


def _rows(index: dict[str, int], choice: str, seen: NDArray[np.bool_]) -> list[int]:
    """The markers that an entry names; none unless all are there and seen at least once."""
    rows = [index.get(name, -1) for name in choice.split()]
    return rows if all(row >= 0 and seen[:, row].any() for row in rows) else []


def _filled(places: Array) -> Array:
    """Places (F, 3) with gaps filled in by straight lines, ends held."""
    seen = np.flatnonzero(np.isfinite(places).all(axis=-1))
    frames = np.arange(len(places))
    return np.stack([np.interp(frames, seen, places[seen, axis]) for axis in range(3)], axis=-1)


def _up(found: dict[str, Array]) -> Array:
    """The axis of the room that points up: from ankles to neck."""
    tall = np.median(found["neck"] - 0.5 * (found["R ankle"] + found["L ankle"]), axis=0)
    axis = int(np.abs(tall).argmax())
    return np.sign(tall[axis]) * np.eye(3)[axis]


class _Body:
    """Joints and axes from the places of roles, z up."""

    def __init__(self, found: dict[str, Array], stature: float, markers: Markers) -> None:
        self.found, self.stature, self.markers = found, stature, markers
        frames = len(markers.places)
        self.places = np.empty((frames, len(TRACKED), 3))
        self.rotations = np.empty((frames, len(TRACKED), 4))

    def motion(self) -> BodyMotion:
        """The whole body's motion."""
        self._pelvis()
        for side, name in (("R", "right"), ("L", "left")):
            self._leg(side, name)
        self._trunk()
        for side, name in (("R", "right"), ("L", "left")):
            self._arm(side, name)
        self._neutral()
        toes = np.stack([self.found["R toe"], self.found["L toe"]], axis=1)
        return BodyMotion(self.rotations, self.places, toes, self.markers.rate)

    def _pelvis(self) -> None:
        """Hips and hip centres: from the middle of the front 36 % of its width aside, 19 % back, 30 % down."""
        right, left = self.found["R front of the pelvis"], self.found["L front of the pelvis"]
        front, width = 0.5 * (right + left), np.linalg.norm(left - right, axis=-1, keepdims=True)
        across = _unit(left - right)
        back = _unit(_without(self.found["back of the pelvis"] - front, across))
        up = np.cross(across, back)
        self.rotations[:, 0] = _frame(up, across)
        centre = front + width * (0.19 * back - 0.30 * up)
        self._put("right_upper_leg", centre - 0.36 * width * across)
        self._put("left_upper_leg", centre + 0.36 * width * across)
        self._put("hips", centre)
        self._put("spine", centre + _WAIST * self.stature * up)

    def _leg(self, side: str, name: str) -> None:
        """Knee, ankle and the leg's axes; the knee is a hinge, square to the foot."""
        knee, ankle = self.found[f"{side} knee"], self.found[f"{side} ankle"]
        ahead = self.found[f"{side} toe"] - self.found[f"{side} heel"]
        left = _unit(np.cross(knee - ankle, ahead))
        inward = left if side == "R" else -left
        knee = self._inner(f"{side} inner knee", knee, _HALF_KNEE * self.stature * inward)
        ankle = self._inner(f"{side} inner ankle", ankle, _HALF_ANKLE * self.stature * inward)
        hip = self.places[:, INDEX[f"{name}_upper_leg"]]
        self._put(f"{name}_lower_leg", knee)
        self._put(f"{name}_foot", ankle)
        self.rotations[:, INDEX[f"{name}_upper_leg"]] = _frame(knee - hip, left)
        self.rotations[:, INDEX[f"{name}_lower_leg"]] = _frame(ankle - knee, left)
        self.rotations[:, INDEX[f"{name}_foot"]] = _frame(ahead, left)

    def _inner(self, role: str, outer: Array, step: Array) -> Array:
        """A joint's centre: the middle of the outer and the inner marker, or a usual step inwards."""
        return 0.5 * (outer + self.found[role]) if role in self.found else outer + step

    def _trunk(self) -> None:
        """Spine and head; the neck is over the spine, shoulders give the trunk's turn."""
        neck, waist = self.found["neck"], self.places[:, INDEX["spine"]]
        across = self.found["L shoulder"] - self.found["R shoulder"]
        self.rotations[:, INDEX["spine"]] = _frame(neck - waist, across)
        self._put("head", neck)
        ahead = _unit(self.found["front of the head"] - self.found["back of the head"])
        middle = 0.5 * (self.found["front of the head"] + self.found["back of the head"])
        across = np.cross(middle - neck, ahead)
        self.rotations[:, INDEX["head"]] = _frame(np.cross(ahead, across), across)

    def _arm(self, side: str, name: str) -> None:
        """Shoulder under its marker, elbow within its own, and the arm's axes."""
        q_trunk = self.rotations[:, INDEX["spine"]]
        shoulder = self.found[f"{side} shoulder"] - _ACROMION * self.stature * rotate(q_trunk, _X)
        marker, wrist = self.found[f"{side} elbow"], self.found[f"{side} wrist"]
        hinge = self._hinge(q_trunk, shoulder, marker, wrist)
        outward = hinge if side == "R" else -hinge
        elbow = marker - _HALF_ELBOW * self.stature * outward
        self._put(f"{name}_upper_arm", shoulder)
        self._put(f"{name}_lower_arm", elbow)
        self._put(f"{name}_hand", wrist)
        self.rotations[:, INDEX[f"{name}_upper_arm"]] = _frame(elbow - shoulder, hinge)
        thumb, little = f"{side} thumb side", f"{side} little side"
        across = hinge
        if thumb in self.found and little in self.found:  # the hand's -z is on the thumb's side, and y = z x x
            across = np.cross(self.found[little] - self.found[thumb], wrist - elbow)
        self.rotations[:, INDEX[f"{name}_lower_arm"]] = _frame(wrist - elbow, across)
        hand = self.found.get(f"{side} knuckle", 2.0 * wrist - elbow) - wrist
        self.rotations[:, INDEX[f"{name}_hand"]] = _frame(hand, across)

    def _hinge(self, q_trunk: Array, shoulder: Array, elbow: Array, wrist: Array) -> Array:
        """The elbow's axis (F, 3): square to its plane where it is bent, else as a hanging arm has it."""
        upper, lower = elbow - shoulder, wrist - elbow
        square = np.cross(_unit(upper), _unit(lower))
        bend = np.arcsin(np.clip(np.linalg.norm(square, axis=-1), 0.0, 1.0))
        share = np.clip((bend - _CERTAIN[0]) / (_CERTAIN[1] - _CERTAIN[0]), 0.0, 1.0)[:, None]
        hanging = rotate(q_trunk, -_X)
        aside = rotate(between(hanging, upper), rotate(q_trunk, -_Y))
        return _unit(share * _unit(square) + (1.0 - share) * aside)

    def _put(self, link: str, places: Array) -> None:
        self.places[:, INDEX[link]] = places

    def _neutral(self) -> None:
        """Turn hips, spine and head so that they are upright, on the mean, in the most upright frames."""
        frames = self._most_upright()
        across = self.places[frames, INDEX["left_upper_leg"]] - self.places[frames, INDEX["right_upper_leg"]]
        body = from_axis_angle(_Z, np.arctan2(-across[:, 0], across[:, 1]))
        for name in ("hips", "spine", "head"):
            link = INDEX[name]
            turns = multiply(conjugate(self.rotations[frames, link]), multiply(body, UPRIGHT_WORLD[link]))
            turn = normalize(align(turns, turns[0]).sum(axis=0))
            self.rotations[:, link] = multiply(self.rotations[:, link], turn)

    def _most_upright(self) -> NDArray[np.intp]:
        """The frames in which trunk, thighs and shins are most upright."""
        down = rotate(
            self.rotations[:, [INDEX[f"{s}_{p}_leg"] for s in ("right", "left") for p in ("upper", "lower")]], _X
        )
        up = rotate(self.rotations[:, INDEX["spine"]], _X)
        score = np.minimum(-down[..., 2].max(axis=1), up[:, 2])
        if score.max() < 0.75:
            raise DataError(
                self.markers.file, "markers", "nobody stands upright in any frame; begin with a standing pose"
            )
        best = np.argsort(-score)[: max(len(score) // 4, 1)]
        return best[score[best] >= score.max() - 0.1]


def _unit(v: Array) -> Array:
    return v / np.maximum(np.linalg.norm(v, axis=-1, keepdims=True), 1e-12)


def _without(v: Array, axis: Array) -> Array:
    """Vectors (..., 3) less their part along a unit axis (..., 3)."""
    return v - axis * np.einsum("...i,...i->...", v, axis)[..., None]


def _frame(x: Array, y: Array) -> Array:
    """Rotations (..., 4) whose x axis is x and whose y axis is as near to y as may be; both (..., 3)."""
    x = _unit(x)
    y = _unit(_without(y, x))
    return from_matrix(np.stack([x, y, np.cross(x, y)], axis=-1))
