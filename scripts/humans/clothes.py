"""What is painted on clothes and hands: bands, pockets, fastenings, badge and nails, as stencils."""

from __future__ import annotations

import numpy as np
from manifold3d import Manifold

from ahmss.body.array import Array
from humans.arm import FINGERS, finger_chain
from humans.body import Stencil, prism
from humans.figure import Figure
from humans.shoe import SOLE_HEIGHT
from humans.trunk import collar_plane, neck_axis

__all__ = ["hems", "stencils"]


def stencils(figure: Figure) -> list[Stencil]:
    """All of them, in the order of painting."""
    own = _polo(figure) if figure.female else _overalls(figure)
    return [_collar(figure), _soles(), *own, *_nails(figure)]


def hems(figure: Figure) -> dict[str, Manifold]:
    """What is cut off the shirt's sleeves and the trousers' legs, so that they end straight."""
    if figure.long_sleeves:
        cuff = _limb(figure, "lower_arm", "hand", 0.93, 1.15, 0.075)
    else:
        cuff = _limb(figure, "upper_arm", "lower_arm", 0.52, 0.70, 0.075)
    return {"shirt": cuff, "trousers": _limb(figure, "lower_leg", "foot", 0.99, 1.3, 0.1)}


def _front(figure: Figure, outline: list[tuple[float, float]]) -> Manifold:
    """An outline of y in metres and z in shares of stature, as a prism through the front of the body."""
    shape = np.array(outline) * np.array([1.0, figure.height])
    y, z = shape.T
    area = np.sum(y * np.roll(z, -1) - z * np.roll(y, -1))
    return prism(shape if area > 0 else shape[::-1], 0.02, 0.4)


def _rectangle(figure: Figure, y: tuple[float, float], z: tuple[float, float]) -> Manifold:
    return _front(figure, [(y[0], z[0]), (y[1], z[0]), (y[1], z[1]), (y[0], z[1])])


def _ring(start: Array, end: Array, low: float, high: float, radius: float) -> Manifold:
    """A disc around the line from start to end, between two shares of it, and its mirror at y = 0."""
    along = end - start
    length = float(np.linalg.norm(along))
    z = along / length
    x = np.cross([0.0, 1.0, 0.0], z)
    x /= np.linalg.norm(x)
    frame = np.column_stack([x, np.cross(z, x), z, start + low * along])
    disc = Manifold.cylinder((high - low) * length, radius, radius, 12).transform(frame)
    return disc + disc.mirror((0.0, 1.0, 0.0))


def _limb(figure: Figure, upper: str, lower: str, low: float, high: float, radius: float) -> Manifold:
    return _ring(figure.bind.place(f"right_{upper}"), figure.bind.place(f"right_{lower}"), low, high, radius)


def _collar(figure: Figure) -> Stencil:
    """What of the shirt lies above the collar's lower edge and near the neck."""
    point, up = collar_plane(figure)
    across = np.array([0.0, 1.0, 0.0])
    disc = Manifold.cylinder(0.08, 0.115, 0.115, 20)
    return Stencil(disc.transform(np.column_stack([np.cross(across, up), across, up, point])), {"shirt": "collar"})


def _soles() -> Stencil:
    slab = Manifold.cube((1.0, 2.0, 0.1 + SOLE_HEIGHT - 0.003)).translate((-0.5, -1.0, -0.1))
    return Stencil(slab, {"shoe": "sole"})


def _polo(figure: Figure) -> list[Stencil]:
    """Sleeve hems and a placket with two buttons in the collar's colour."""
    top = float(neck_axis(figure)[1][2]) / figure.height
    hem = _limb(figure, "upper_arm", "lower_arm", 0.465, 0.54, 0.075)
    buttons = [_button(figure, z) for z in (top - 0.050, top - 0.074)]
    return [
        Stencil(hem, {"shirt": "collar"}),
        Stencil(_rectangle(figure, (-0.013, 0.013), (top - 0.094, top)), {"shirt": "collar"}),
        Stencil(buttons[0] + buttons[1], {"collar": "button"}),
        Stencil(_rectangle(figure, (0.040, 0.072), (0.752, 0.764)), {"shirt": "badge"}),
    ]


def _button(figure: Figure, z: float) -> Manifold:
    angle = np.linspace(0.0, 2.0 * np.pi, 8, endpoint=False)
    return _front(figure, [(0.0045 * np.cos(a), z + 0.0045 * np.sin(a) / figure.height) for a in angle])


def _overalls(figure: Figure) -> list[Stencil]:
    """A zip, flaps of the chest pockets, a badge, and bright bands on sleeves and shins."""
    top = float(neck_axis(figure)[1][2]) / figure.height
    flaps = Manifold()
    for sign in (1.0, -1.0):
        flaps += _front(figure, [(sign * y, z) for y, z in (
            (0.050, 0.764), (0.124, 0.764), (0.124, 0.750), (0.087, 0.743), (0.050, 0.750))])  # fmt: skip
    sleeve = _limb(figure, "upper_arm", "lower_arm", 0.52, 0.66, 0.09)
    shin = _limb(figure, "lower_leg", "foot", 0.52, 0.64, 0.11)
    return [
        Stencil(_rectangle(figure, (-0.004, 0.004), (0.55, top)), {"shirt": "trim", "trousers": "trim"}),
        Stencil(flaps, {"shirt": "collar"}),
        Stencil(_rectangle(figure, (0.062, 0.112), (0.770, 0.780)), {"shirt": "badge"}),
        Stencil(sleeve + shin, {"shirt": "band", "trousers": "band"}),
    ]


def _nails(figure: Figure) -> list[Stencil]:
    """The backs of the fingers' ends."""
    nails = Manifold()
    for finger, segments in FINGERS.items():
        chain, radii = finger_chain(figure, finger)
        axes = figure.bind.matrix(f"right_{finger}_{segments[-1]}")
        along, dorsal, across = axes[:, 0], axes[:, 1], axes[:, 2]  # the right palm faces -y
        r = float(radii[-1])
        centre = chain[-1] + 0.15 * r * along + 0.95 * r * dorsal
        size = np.array([1.05 * r, 0.62 * r, 0.72 * r])
        ball = Manifold.sphere(1.0, 8).scale(tuple(size)).transform(np.column_stack([along, dorsal, across, centre]))
        nails += ball + ball.mirror((0.0, 1.0, 0.0))
    return [Stencil(nails, {"skin": "nail"})]
