"""From a file's joints to our 15 links: which constant turn lies between a joint's axes and those of its link.

Files differ in their zero pose (T, A, arms hanging, or all bones along one axis), so nothing is taken from it unseen.
A *reference pose* is one in which a person stands: the zero pose where it is such a pose, else the frame that is most
upright. In it each link's x axis is laid along its bone as the offsets have it, by the smallest turn from our upright
pose; what is then between joint and link stays constant. Many joints of a trunk become one link: its x axis goes from
the waist to the neck, its turn is the chest's.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from scipy.interpolate import CubicSpline

from ahmss.body.array import Array
from ahmss.body.links import INDEX, LINKS
from ahmss.body.quaternion import IDENTITY, between, conjugate, from_matrix, multiply, normalize, rotate
from ahmss.body.quaternion import align as align_signs
from ahmss.body.skeleton import UPRIGHT_WORLD
from ahmss.errors import DataError
from ahmss.motion.naming import SIDES, Parts
from ahmss.motion.resample import interpolate_rotations
from ahmss.motion.source import SourceMotion

__all__ = ["TRACKED", "BodyMotion", "align", "upward"]

TRACKED = LINKS[:15]
_WAIST_SHARE = 0.19  # of the way from hips to neck, where our spine's joint lies (Drillis & Contini 1966)
_NEXT = {"upper_arm": "lower_arm", "lower_arm": "hand", "upper_leg": "lower_leg", "lower_leg": "foot"}
_STANDING = 0.9  # least cosine of trunk, thighs and shins to up in a zero pose that serves
_UPRIGHT = 0.75  # least cosine of trunk, thighs and shins to up in a frame that serves
_MEAN_OF, _NEARLY = 0.25, 0.1  # the best share of the frames, not worse than the best by more than this
_X, _Y = np.array([1.0, 0.0, 0.0]), np.array([0.0, 1.0, 0.0])


@dataclass(frozen=True, eq=False)
class BodyMotion:
    """What a motion says of the body, with the lengths of whoever performed it.

    rotations (F, 15, 4), world <- link, axes as ours; places (F, 15, 3) of the links' joints and toes (F, 2, 3) of the
    right and left toes' joints, world, z up, metres; rate in frames a second.
    """

    rotations: Array
    places: Array
    toes: Array
    rate: float

    @property
    def frames(self) -> int:
        """How many frames there are."""
        return int(self.rotations.shape[0])

    def at_rate(self, rate: float) -> BodyMotion:
        """The same motion in other frames."""
        if rate == self.rate or self.frames < 2:
            return replace(self, rate=rate)
        known = np.arange(self.frames) / self.rate
        times = np.arange(int((self.frames - 1) * rate / self.rate + 1e-6) + 1) / rate
        return BodyMotion(
            interpolate_rotations(known, self.rotations, times),
            CubicSpline(known, self.places)(times),
            CubicSpline(known, self.toes)(times),
            rate,
        )


@dataclass(frozen=True, eq=False)
class _Reference:
    """A pose in which a person stands: places (J, 3), rotations (J, 4), world <- joint, and our axes in it.

    body (4,): from our world at heading 0 (x ahead, y to the left, z up) to this pose's.
    """

    places: Array
    world: Array
    body: Array


def align(source: SourceMotion, parts: Parts, metres: float) -> tuple[BodyMotion, list[str]]:
    """The motion of our links, and what there is to say of it.

    Args:
        source: the file's motion.
        parts: which joint is what.
        metres: of one unit of length.

    Raises:
        DataError: neither zero pose nor any frame is one of a person who stands.
    """
    places, world = source.world()
    up = upward(parts, places)
    references, kind = _references(source, parts, places, world, up)
    joints = [_joint_of(parts, name) for name in TRACKED]
    mounts = [multiply(conjugate(reference.world[joints]), _links_in(reference, parts)) for reference in references]
    rotations = multiply(world[:, joints], _mean(mounts))
    rotations[:, INDEX["spine"]] = _trunk(parts, references, places, world)
    lift = between(up, np.array([0.0, 0.0, 1.0]))
    body = BodyMotion(
        rotations=multiply(lift, rotations),
        places=metres * rotate(lift, _places(parts, places, _waist(parts, references[0].places))),
        toes=metres * rotate(lift, places[:, [_toe(parts, side) for side in SIDES]]),
        rate=source.rate,
    )
    return body, [kind, *([] if up[1] > 0.5 else [f"up is {_named(up)}"])]


def _named(axis: Array) -> str:
    i = int(np.abs(axis).argmax())
    return ("-" if axis[i] < 0 else "") + "xyz"[i]


def _toe(parts: Parts, side: str) -> int:
    """The joint of the toes; without one, what the foot points to, or the foot itself."""
    foot = parts.limbs[f"{side}_foot"]
    return parts.limbs.get(f"{side}_toe", parts.tips.get(f"{side}_foot", foot))


def _joint_of(parts: Parts, link: str) -> int:
    """The joint whose rotation a link has."""
    if link == "hips":
        return parts.hips
    if link == "spine":
        return parts.chest
    if link == "head":
        return parts.head
    return parts.limbs.get(link.replace("_hand", "_palm"), parts.limbs[link])


def _waist(parts: Parts, places: Array) -> int:
    """The joint of the spine that is nearest to where ours is, in places (J, 3)."""
    hips = 0.5 * (places[parts.limbs["right_upper_leg"]] + places[parts.limbs["left_upper_leg"]])
    way = places[parts.neck] - hips
    shares = [float((places[joint] - hips) @ way / (way @ way)) for joint in parts.spine]
    return parts.spine[int(np.argmin(np.abs(np.array(shares) - _WAIST_SHARE)))]


def _places(parts: Parts, places: Array, waist: int) -> Array:
    """Where the links' joints are (F, 15, 3), in the file's unit and axes."""
    joints = [parts.limbs.get(name, 0) for name in TRACKED]
    joints[INDEX["spine"]], joints[INDEX["head"]] = waist, parts.neck
    out = places[:, joints]
    out[:, 0] = 0.5 * (places[:, parts.limbs["right_upper_leg"]] + places[:, parts.limbs["left_upper_leg"]])
    return out


def upward(parts: Parts, places: Array) -> Array:
    """The axis of the file's world that points up: where heads are above feet; y where that says nothing."""
    feet = [parts.limbs["right_foot"], parts.limbs["left_foot"]]
    tall = np.median(places[:, parts.head] - places[:, feet].mean(axis=1), axis=0)
    tall = tall / max(float(np.linalg.norm(tall)), 1e-12)
    up = np.zeros(3)
    axis = int(np.abs(tall).argmax())
    up[axis] = np.sign(tall[axis])
    return up if np.abs(tall[axis]) > 0.8 and axis > 0 else np.array([0.0, 1.0, 0.0])


def _references(
    source: SourceMotion, parts: Parts, places: Array, world: Array, up: Array
) -> tuple[list[_Reference], str]:
    """Poses of somebody who stands, and a word on where they come from.

    Frames in which somebody walks are all a little aside of standing, now here, now there: their mean serves.
    """
    zero = source.zero_pose()
    axes = np.concatenate([up[None], np.eye(3), -np.eye(3)])
    standing = [float(_uprightness(parts, zero[None], axis)[0]) for axis in axes]
    best = int(np.argmax(standing))
    if standing[best] > _STANDING:
        identity = np.tile(IDENTITY, (len(source.names), 1))
        return [_Reference(zero, identity, _body(parts, zero, axes[best]))], "aligned by its zero pose"
    found = _uprightness(parts, places, up)
    if found.max() < _UPRIGHT:
        said = "nobody stands, neither in the zero pose nor in any frame; begin with a standing pose"
        raise DataError(source.file, "joints", said)
    frames = np.argsort(-found)[: max(int(_MEAN_OF * len(found)), 1)]
    frames = frames[found[frames] >= found.max() - _NEARLY]
    said = f"nobody stands in its zero pose: aligned by its {len(frames)} most upright frames"
    return [_Reference(places[i], world[i], _body(parts, places[i], up)) for i in frames], said


def _uprightness(parts: Parts, places: Array, up: Array) -> Array:
    """How upright poses (n, J, 3) are (n,): the smallest cosine of trunk, thighs and shins to up."""
    limbs = parts.limbs
    bones = [(parts.hips, parts.neck)]
    for side in SIDES:
        bones += [(limbs[f"{side}_lower_leg"], limbs[f"{side}_upper_leg"])]
        bones += [(limbs[f"{side}_foot"], limbs[f"{side}_lower_leg"])]
    lower, upper = np.array(bones).T
    ways = places[:, upper] - places[:, lower]
    return ((ways @ up) / np.maximum(np.linalg.norm(ways, axis=-1), 1e-12)).min(axis=1)


def _body(parts: Parts, places: Array, up: Array) -> Array:
    """From our world at heading 0 to a standing pose's (4,)."""
    right, left = (places[parts.limbs[f"{side}_upper_leg"]] for side in SIDES)
    across: Array = left - right
    across = across - up * (across @ up)
    across /= np.linalg.norm(across)
    return from_matrix(np.stack([np.cross(across, up), across, up], axis=-1))


def _links_in(reference: _Reference, parts: Parts) -> Array:
    """World rotations (15, 4) of our links in the reference pose."""
    places, limbs = reference.places, parts.limbs
    links = multiply(reference.body, UPRIGHT_WORLD[: len(TRACKED)])
    for side in SIDES:
        for chain in (("upper_arm", "lower_arm", "hand"), ("upper_leg", "lower_leg")):
            turn = IDENTITY
            for part in chain:
                link = INDEX[f"{side}_{part}"]
                links[link] = multiply(turn, links[link])
                bone = _bone(parts, places, f"{side}_{part}")
                if bone is not None:
                    swing = between(rotate(links[link], _X), bone)
                    links[link], turn = multiply(swing, links[link]), multiply(swing, turn)
        foot = INDEX[f"{side}_foot"]
        ahead = rotate(conjugate(reference.body), places[_toe(parts, side)] - places[limbs[f"{side}_foot"]])
        ahead[2] = 0.0
        if np.linalg.norm(ahead) > 1e-9:
            links[foot] = multiply(reference.body, between(_X, ahead))
    return links


def _bone(parts: Parts, places: Array, name: str) -> Array | None:
    """The direction of a limb's link in a pose, None where the file doesn't say."""
    side, part = name.split("_", 1)
    if part in _NEXT:
        end = parts.limbs[f"{side}_{_NEXT[part]}"]
    else:
        end = parts.limbs.get(f"{side}_palm", -1)
        if end < 0 or np.linalg.norm(places[end] - places[parts.limbs[name]]) < 1e-9:
            end = parts.tips.get(f"{side}_palm", parts.tips.get(name, -1))
    if end < 0:
        return None
    bone = places[end] - places[parts.limbs[name]]
    return bone if np.linalg.norm(bone) > 1e-9 else None


def _trunk(parts: Parts, references: list[_Reference], places: Array, world: Array) -> Array:
    """The trunk's rotations (F, 4): x from waist to neck, turned as the chest is."""
    waist = _waist(parts, references[0].places)
    lefts = [rotate(reference.body, _Y) for reference in references]
    local = np.mean(
        [rotate(conjugate(r.world[parts.chest]), left) for r, left in zip(references, lefts, strict=True)], axis=0
    )
    mounts = [
        multiply(
            conjugate(_frame(r.places[parts.neck] - r.places[waist], rotate(r.world[parts.chest], local))),
            multiply(r.body, UPRIGHT_WORLD[INDEX["spine"]]),
        )
        for r in references
    ]
    now = _frame(places[:, parts.neck] - places[:, waist], rotate(world[:, parts.chest], local))
    return multiply(now, _mean(mounts))


def _mean(rotations: list[Array]) -> Array:
    """The mean (..., 4) of rotations that are near to each other."""
    return normalize(np.sum([align_signs(q, rotations[0]) for q in rotations], axis=0))


def _frame(x: Array, y: Array) -> Array:
    """Rotations (..., 4) whose x axis is x and whose y axis is as near to y as may be; both (..., 3)."""
    x = x / np.linalg.norm(x, axis=-1, keepdims=True)
    y = y - x * np.einsum("...i,...i->...", x, y)[..., None]
    y = y / np.linalg.norm(y, axis=-1, keepdims=True)
    return from_matrix(np.stack([x, y, np.cross(x, y)], axis=-1))
