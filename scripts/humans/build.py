"""From a figure to its skinned mesh."""

from __future__ import annotations

import numpy as np
from manifold3d import Manifold
from numpy.typing import NDArray

from ahmss.body.array import Array
from humans import arm, clothes, face, hair, head, shoe, trunk, weights
from humans.body import Body, Painting
from humans.distance import Field
from humans.figure import Figure
from humans.gltf import Skinned
from humans.mesh import Part, mesh
from humans.shade import shaded

__all__ = ["build"]

_RIGHT_SHOE = (np.array([-0.12, -0.28, 0.0]), np.array([0.26, -0.03, 0.16]))


def build(figure: Figure) -> Skinned:
    """Model, join, paint and skin one human."""
    painting = Painting()
    painting.lay(_joined(figure, painting))
    for stencil in (*face.stencils(figure), *clothes.stencils(figure)):
        painting.paint(stencil)
    body = painting.body()
    joints, shares = weights.skin_weights(figure, body.points, body.faces)
    return _split(figure, body, painting.fields, joints, shares)


def _box(figure: Figure, x: tuple[float, float], y: float, z: tuple[float, float]) -> tuple[Array, Array]:
    """A box in metres; heights are shares of stature."""
    h = figure.height
    return np.array([x[0], -y, z[0] * h]), np.array([x[1], y, z[1] * h])


def _joined(figure: Figure, painting: Painting) -> Manifold:
    """All parts as one solid."""
    parts = [
        mesh(trunk.shirt(figure), _box(figure, (-0.2, 0.25), 0.64, (0.55, 0.9)), 0.005, 1300, "shirt"),
        mesh(trunk.trousers(figure), _box(figure, (-0.25, 0.25), 0.36, (0.02, 0.63)), 0.007, 720, "trousers"),
        mesh(trunk.belt(figure), _box(figure, (-0.25, 0.25), 0.36, (0.55, 0.63)), 0.005, 90, "belt"),
    ]
    drawing = head.Drawing.of(figure)
    around = (drawing.place(-17, -10, -12), drawing.place(11, 10, 12))
    parts.append(mesh(hair.hair(figure), around, 0.003, 1400, "hair"))
    if figure.female:
        around = (drawing.place(-14, -3, 2), drawing.place(-8, 3, 9))
        parts.append(mesh(hair.hair_band(figure), around, 0.0025, 70, "band"))
    for right in (
        _arm(figure),
        mesh(shoe.shoe(figure), _RIGHT_SHOE, 0.003, 240, "shoe"),
    ):
        parts += [right, right.mirrored()]
    solid = _head(figure, painting)
    hems = clothes.hems(figure)
    for part in parts:
        piece = painting.part(part.solid(), part.colour, part.field)
        if part.colour in hems:
            piece = piece - painting.part(hems[part.colour], part.colour, None)
        solid = solid + piece
    return solid


def _arm(figure: Figure) -> Part:
    """The right arm as far as the sleeve leaves it bare, with its hand."""
    turn = figure.bind.matrix("right_hand")
    fingers = [arm.finger_chain(figure, finger)[0] for finger in arm.FINGERS]
    start = figure.bind.place("right_lower_arm" if figure.long_sleeves else "right_upper_arm")
    around = np.concatenate([[start], *fingers]) @ turn
    field = arm.arm(figure, 0.75 if figure.long_sleeves else 0.25)
    return mesh(field, (around.min(0) - 0.055, around.max(0) + 0.055), 0.0018, 1100, "skin", turn)


def _head(figure: Figure, painting: Painting) -> Manifold:
    """Head with eyes behind their openings."""
    drawing = head.Drawing.of(figure)
    around = (drawing.place(-11, -9.5, -24), drawing.place(11.5, 9.5, 11))
    skin = mesh(head.head(figure), around, 0.0022, 2600, "skin")
    # Shade is kept at the vertices: no face of the neck may be long.
    solid = painting.part(skin.solid().refine_to_length(0.032), "skin", skin.field)
    upper, lower = face.eye_openings(figure)
    solid = solid - painting.part(upper, "lash", None) - painting.part(lower, "rim", None)
    centre, radius = np.array(head.EYE_BALL[:3]), head.EYE_BALL[3]

    def ball(p: Array) -> Array:
        return (np.linalg.norm(drawing.drawn(p) - centre, axis=1) - radius) * drawing.scale

    return solid + painting.part(face.eyeballs(figure), "white", ball)


def _split(figure: Figure, body: Body, fields: list[Field | None], joints: NDArray[np.uint8], shares: Array) -> Skinned:
    """Points become vertices, one for each part and colour that meets in them; normals come from the parts' fields."""
    names = sorted(set(body.colour))
    colour = np.array([names.index(name) for name in body.colour])
    flat = np.array([field is None for field in fields])[body.part]
    group = np.where(flat, len(fields) + np.arange(len(body.faces)), body.part)
    corners = np.column_stack([body.faces.reshape(-1), np.repeat(group, 3), np.repeat(colour, 3)])
    vertices, faces = np.unique(corners, axis=0, return_inverse=True)
    faces = faces.reshape(-1, 3)
    point = vertices[:, 0]
    normals = _normals(body.points[point], faces, vertices[:, 1], fields)
    colours = shaded(figure, body.points[point], normals, [names[i] for i in vertices[:, 2]], fields)
    return Skinned(body.points[point], normals, colours, joints[point], shares[point], faces, figure.bind.frames())


def _normals(points: Array, faces: NDArray[np.int64], group: NDArray[np.int64], fields: list[Field | None]) -> Array:
    """Unit normals (n, 3): the gradient of the part's field where that agrees with the faces, else the faces' mean."""
    corner = points[faces]
    area = np.cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0])
    mean = np.zeros_like(points)
    for k in range(3):
        np.add.at(mean, faces[:, k], area)
    mean /= np.maximum(np.linalg.norm(mean, axis=1, keepdims=True), 1e-15)
    normals = mean.copy()
    for index, field in enumerate(fields):
        rows = np.flatnonzero(group == index)
        if field is None or len(rows) == 0:
            continue
        gradient = np.zeros((len(rows), 3))
        for axis in range(3):
            step = np.zeros(3)
            step[axis] = 0.0012
            gradient[:, axis] = field(points[rows] + step) - field(points[rows] - step)
        gradient /= np.maximum(np.linalg.norm(gradient, axis=1, keepdims=True), 1e-12)
        agrees = np.einsum("ij,ij->i", gradient, mean[rows]) > 0.5
        normals[rows] = np.where(agrees[:, None], gradient, mean[rows])
    return normals
