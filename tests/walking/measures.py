"""What is measured of walks, each figure by itself, from the frames and from what the walk says of its feet."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cache
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from scipy.signal import butter, sosfiltfilt

from ahmss.body.array import Array
from ahmss.body.kinematics import forward
from ahmss.body.links import INDEX
from ahmss.body.quaternion import conjugate, multiply, rotate, to_rotation_vector
from ahmss.body.skeleton import Skeleton
from ahmss.database import Workspace
from ahmss.main.stance import standing
from ahmss.motion.contact import foot_points, runs
from ahmss.motion.footing import Support, support
from ahmss.motion.smoothness import JointMotion, angular_steps, joint_motion, pops
from ahmss.walking.course import Course, plan
from ahmss.walking.journey import Footing, Journey, Standing, footing, journey
from ahmss.walking.library import BODY, RATE, Library, load

ROOT = Path(__file__).resolve().parents[2]
HUMANS = ("ken", "aiko")
FEET = [INDEX["right_foot"], INDEX["left_foot"]]
KNEES = [INDEX["right_lower_leg"], INDEX["left_lower_leg"]]
HIPS = [INDEX["right_upper_leg"], INDEX["left_upper_leg"]]

# Real capture, the worst of its walks: ../shared/READING.md, "What real motion capture measures".
SUPPORT_MEAN, SUPPORT_P95 = 0.073, 0.212  # m/s
ACCELERATION_MAX, ACCELERATION_P99 = 382.0, 213.0  # rad/s2
JERK_MAX = 15_000.0  # rad/s3
# The straight walk of ../shared/mocap (B03_Walk1) brought to 60 Hz: its largest pop, and the hips' acceleration.
POP, HIPS_ACCELERATION = 6.0, 24.0  # degrees, m/s2

_TOUCHING, _NEAR, _LOW = 1e-4, 0.002, 0.04  # metres over the floor


@cache
def library() -> Library:
    """The shipped one."""
    return load(ROOT / "objectdb" / "floor" / "walk.npz")


@dataclass(frozen=True)
class Subject:
    """A human of humandb that stands at the origin."""

    skeleton: Skeleton
    standing: Standing
    rotations: Array
    root: Array

    def at(self, place: tuple[float, float], degrees: float) -> tuple[Array, Array]:
        """Its pose (43, 4), (3,) standing at a place, heading so."""
        return standing(Workspace(ROOT).humans.get(self.skeleton.name), place, degrees)


@cache
def subject(name: str) -> Subject:
    model = Workspace(ROOT).humans.get(name)
    rotations, root = standing(model, (0.0, 0.0), 0.0)
    return Subject(model.skeleton, Standing.of(model.skeleton, library()), rotations, root)


@dataclass(frozen=True)
class Goal:
    """A walk asked for: from the origin, heading `start`, `distance` in `direction` against that, then to `facing`.

    Angles in degrees; `facing` is against the heading at the start. name: whose walk.
    """

    name: str
    start: float
    distance: float
    direction: float
    facing: float

    def __str__(self) -> str:
        return f"{self.name}-{self.start:.0f}-{self.distance:.3f}m-{self.direction:.1f}-{self.facing:.1f}"

    @property
    def place(self) -> Array:
        way = np.radians(self.start + self.direction)
        return self.distance * np.array([np.cos(way), np.sin(way)])

    @property
    def heading(self) -> float:
        """Radians, world."""
        return float(np.radians(self.start + self.facing))


@dataclass(frozen=True)
class Walk:
    """Frames of a walk as shown: rotations (F, 43, 4), root (F, 3), bearing (F, 2, 3), and the feet it wants."""

    skeleton: Skeleton
    rotations: Array
    root: Array
    bearing: NDArray[np.bool_]
    ankles: Array
    feet: Array
    seams: tuple[int, ...] = ()
    places: Array = field(init=False)
    world: Array = field(init=False)

    def __post_init__(self) -> None:
        places, world = forward(self.rotations, self.root, self.skeleton.offsets)
        object.__setattr__(self, "places", places)
        object.__setattr__(self, "world", world)

    @property
    def seconds(self) -> float:
        return (len(self.root) - 1) / RATE


def of_journey(body: Subject, made: Journey) -> Walk:
    shaped = made.shaped
    rotations = np.repeat(body.rotations[None], len(shaped.root), axis=0)
    rotations[:, :BODY] = shaped.rotations
    return Walk(body.skeleton, rotations, shaped.root, shaped.bearing, shaped.ankles, shaped.feet, made.seams)


def walked(goal: Goal, frames: int = 0) -> tuple[Walk, Journey]:
    """The walk to a goal over an empty floor."""
    body = subject(goal.name)
    rotations, root = body.at((0.0, 0.0), goal.start)
    now = footing(body.skeleton, rotations, root, body.standing)
    course = straight(now, goal.place)
    made = journey(body.skeleton, library(), body.standing, now, course, goal.heading, frames)
    return of_journey(body, made), made


def straight(now: Footing, place: Array) -> Course:
    return plan(now.place, place, [], radius=0.27, start_heading=now.heading)


# Where it gets to


def heading_of(rotation: Array) -> Array:
    """Headings (...) of pelvises (..., 4), whose z points back: radians."""
    ahead = rotate(rotation, np.array([0.0, 0.0, -1.0]))
    return np.arctan2(ahead[..., 1], ahead[..., 0])


def off(angle: float) -> float:
    """An angle in radians as degrees from 0 to 180."""
    return abs(float(np.degrees((angle + np.pi) % (2.0 * np.pi) - np.pi)))


def arrival(walk: Walk, place: Array, heading: float) -> tuple[float, float]:
    """By how much the hips miss a place (metres) and a heading (degrees)."""
    return float(np.linalg.norm(walk.root[-1, :2] - place)), off(float(heading_of(walk.rotations[-1, 0])) - heading)


# Feet, knees, bones


def drift(walk: Walk) -> float:
    """The furthest that any point gets from where it was set down while it bears, up and down too: metres."""
    soles = foot_points(walk.skeleton, walk.rotations, walk.root)
    furthest = 0.0
    for foot in range(2):
        for point in range(3):
            for first, end in runs(walk.bearing[:, foot, point]):
                way = soles[first:end, foot, point] - soles[first, foot, point]
                furthest = max(furthest, float(np.linalg.norm(way, axis=-1).max()))
    return furthest


def sunk(walk: Walk) -> float:
    """How far any point of a sole or a joint is below the floor, metres."""
    soles = foot_points(walk.skeleton, walk.rotations, walk.root)
    return max(0.0, -float(soles[..., 2].min()), -float(walk.places[..., 2].min()))


def supported(walk: Walk) -> float:
    """The share of frames in which some point of a foot is said to bear."""
    return float(walk.bearing.any(axis=(1, 2)).mean())


def knee_flexion(walk: Walk) -> Array:
    """Degrees (F, 2), right and left: how far the shank is turned back from the line of the thigh."""
    thigh = rotate(walk.world[:, HIPS], np.array([1.0, 0.0, 0.0]))
    shank = rotate(walk.world[:, KNEES], np.array([1.0, 0.0, 0.0]))
    back = -rotate(walk.world[:, HIPS], np.array([0.0, 0.0, 1.0]))
    return np.degrees(np.arctan2((shank * back).sum(axis=-1), (shank * thigh).sum(axis=-1)))


def knees_ahead(walk: Walk) -> Array:
    """Metres (F, 2) that the knee is ahead of the line from hip joint to ankle, by where pelvis and foot point."""
    hip, knee, ankle = (walk.places[:, links] for links in (HIPS, KNEES, FEET))
    line = ankle - hip
    line /= np.linalg.norm(line, axis=-1, keepdims=True)
    way = knee - hip
    way = way - (way * line).sum(axis=-1, keepdims=True) * line
    ahead = rotate(walk.world[:, FEET], np.array([1.0, 0.0, 0.0])) * np.array([1.0, 1.0, 0.0])
    ahead /= np.linalg.norm(ahead, axis=-1, keepdims=True)
    ahead = ahead + rotate(walk.world[:, :1], np.array([0.0, 0.0, -1.0]))
    return (way * ahead).sum(axis=-1)


def missed(walk: Walk) -> float:
    """How far the ankles are at the most from where the walk wants them: metres. A leg too short shows here."""
    return float(np.linalg.norm(walk.places[:, FEET] - walk.ankles, axis=-1).max())


# Smoothness


def joints(walk: Walk) -> JointMotion:
    return joint_motion(walk.rotations, RATE, BODY)


def standing_speed(walk: Walk) -> Support:
    """How still the feet stand, as it is known of real capture."""
    points = foot_points(walk.skeleton, walk.rotations, walk.root)
    points[:, :, 0] = walk.places[:, FEET]
    points[:, :, 0, 2] += walk.skeleton.soles[0, 2]
    return support(points, RATE)


def jerks(walk: Walk) -> Array:
    """Jerk (F, 15) of each joint, rad/s3, filtered as real capture is; 0 in the outer 6 frames."""
    velocity = angular_steps(walk.rotations[:, :BODY]) * RATE
    smooth = sosfiltfilt(butter(2, 10.0, fs=RATE, output="sos"), velocity, axis=0)
    jerk = np.gradient(np.gradient(smooth, 1.0 / RATE, axis=0), 1.0 / RATE, axis=0)
    size = np.zeros((len(walk.root), BODY))
    size[1:] = np.linalg.norm(jerk, axis=-1)
    size[:7], size[-6:] = 0.0, 0.0
    return size


def near_seams(walk: Walk, within: int = 3) -> NDArray[np.bool_]:
    """Which frames (F,) are so near to a place where clips meet."""
    frames = np.arange(len(walk.root))
    inner = np.array(walk.seams[1:-1])
    if not len(inner):
        return np.zeros(len(frames), bool)
    return (np.abs(frames[:, None] - inner) <= within).any(axis=-1)


def worst_pops(walk: Walk) -> tuple[float, float]:
    """The largest pop in degrees near the seams, and elsewhere."""
    size = pops(walk.rotations[:, :BODY]).max(axis=-1)
    near = near_seams(walk)[2:-1]
    return float(size[near].max(initial=0.0)), float(size[~near].max(initial=0.0))


def worst_jerks(walk: Walk) -> tuple[float, float]:
    """The largest jerk near the seams, and elsewhere."""
    size = jerks(walk).max(axis=-1)
    near = near_seams(walk)
    return float(size[near].max(initial=0.0)), float(size[~near].max(initial=0.0))


def hips_acceleration(walk: Walk) -> float:
    """The largest, m/s2, unfiltered: a hip that jumps for a frame shows."""
    return float(np.linalg.norm(np.diff(walk.root, 2, axis=0), axis=-1).max()) * RATE**2


def mean_speed(walk: Walk) -> float:
    """From where one stands to where one stands, by the time from the first lifting to the last landing."""
    bears = walk.bearing.any(axis=-1).all(axis=-1)
    moving = np.flatnonzero(~bears)
    seconds = (moving[-1] - moving[0] + 1) / RATE
    return float(np.linalg.norm(walk.root[-1, :2] - walk.root[0, :2])) / seconds


# Feet and the floor, feet and each other


def scuffed(walk: Walk) -> float:
    """The furthest way that a point goes over the floor while it touches it, declared to bear or not: metres."""
    soles = foot_points(walk.skeleton, walk.rotations, walk.root)
    touches = soles[..., 2] < _TOUCHING
    furthest = 0.0
    for foot in range(2):
        for point in range(3):
            for first, end in runs(touches[:, foot, point]):
                way = soles[first:end, foot, point, :2] - soles[first, foot, point, :2]
                furthest = max(furthest, float(np.linalg.norm(way, axis=-1).max()))
    return furthest


def slid(walk: Walk) -> Array:
    """How far points (F - 1, 2, 3) go between two frames if near the floor in both, whatever the flags: metres."""
    soles = foot_points(walk.skeleton, walk.rotations, walk.root)
    near = soles[..., 2] < _NEAR
    return np.linalg.norm(np.diff(soles[..., :2], axis=0), axis=-1) * (near[1:] & near[:-1])


def beyond(walk: Walk, links: list[int]) -> Array:
    """By how much joints (F, n) are turned beyond their limits, from upright: degrees."""
    upright, _ = walk.skeleton.upright()
    angles = to_rotation_vector(multiply(conjugate(upright[links]), walk.rotations[:, links]))
    low, high = np.moveaxis(walk.skeleton.limits[links], -1, 0)
    return np.degrees(np.maximum(np.maximum(low - angles, angles - high), 0.0).max(axis=-1))


def crossed(walk: Walk) -> int:
    """In how many frames the feet, both low, go through each other: their lines from heel to toe cross."""
    soles = foot_points(walk.skeleton, walk.rotations, walk.root)
    low = (soles[..., 2].min(axis=-1) < _LOW).all(axis=-1)
    a, b = soles[:, :, 0, :2], soles[:, :, 2, :2]

    def sides(foot: int) -> NDArray[np.bool_]:
        """Whether the other foot's heel and toe are on both sides of a foot's line."""
        line, other = b[:, foot] - a[:, foot], 1 - foot
        return _cross(line, a[:, other] - a[:, foot]) * _cross(line, b[:, other] - a[:, foot]) < 0.0

    return int((low & sides(0) & sides(1)).sum())


def shanks_apart(walk: Walk) -> float:
    """How near the lines from knee to ankle of both legs come to each other, metres."""
    t = np.linspace(0.0, 1.0, 21)[None, :, None]
    knees, feet = walk.places[:, KNEES, None], walk.places[:, FEET, None]
    a, b = ((1.0 - t) * knees[:, leg] + t * feet[:, leg] for leg in (0, 1))
    return float(np.linalg.norm(a[:, :, None] - b[:, None], axis=-1).min())


def soles_apart(walk: Walk) -> float:
    """How near the middle lines of both soles, from heel to toe, come to each other while both bear, metres."""
    soles = foot_points(walk.skeleton, walk.rotations, walk.root)
    bear = (soles[..., 2].min(axis=-1) < _NEAR).all(axis=-1)
    a, b = soles[bear][:, :, 0, :2], soles[bear][:, :, 2, :2]
    t = np.linspace(0.0, 1.0, 21)[None, :, None]
    right, left = ((1.0 - t) * a[:, foot, None] + t * b[:, foot, None] for foot in (0, 1))
    return float(np.linalg.norm(right[:, :, None] - left[:, None], axis=-1).min())


def _cross(a: Array, b: Array) -> Array:
    return a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]
