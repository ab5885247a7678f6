"""A human's skinned shape with a motion in it, as one GLB (glTF 2.0) that other programs open.

glTF has y up and looks along +z, we have z up and look along +x: (x, y, z) becomes (y, z, x). The vertices, the inverse
bind matrices and the hips are turned; the other joints turn against their parents and stay as they are. Our shapes'
vertex colours are sRGB, glTF's are linear. Joints rest in the pose that the shape was modelled in.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ahmss.body.array import Array
from ahmss.body.links import CHILDREN, LINKS, PARENTS
from ahmss.body.quaternion import from_matrix, multiply
from ahmss.body.skeleton import Skeleton
from ahmss.motion.glbfile import ARRAY_BUFFER, ELEMENT_BUFFER, GlbReader, GlbWriter, Json
from ahmss.motion.resample import continuous

__all__ = ["Look", "animated"]

_TURN: Array = np.array([[0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]])  # glTF <- ours
_Q_TURN = from_matrix(_TURN)
_TURNED = ("POSITION", "NORMAL")
_XYZW = [1, 2, 3, 0]
_KEPT = ("materials", "textures", "samplers", "images", "extensionsUsed")
_PNG = b"\x89PNG"


@dataclass(frozen=True)
class Look:
    """What a human looks like. shape: a GLB skinned to the 43 links in their order; texture: PNG or JPEG, or none."""

    shape: bytes
    texture: bytes | None = None


def animated(look: Look, skeleton: Skeleton, motion: tuple[Array, Array, float], name: str) -> bytes:
    """The shape's GLB with one animation; what is not skinned is left out.

    Args:
        look: of the human.
        skeleton: its measures; the joints stand at its offsets.
        motion: rotations (F, 43, 4), root (F, 3) in metres, z up, and frames a second.
        name: of the animation.

    Raises:
        ProtocolError: the shape is not a GLB that this can read.
    """
    return _Exporter(look, skeleton).write(motion, name)


class _Exporter:
    """One GLB on its way from one file to the other."""

    def __init__(self, look: Look, skeleton: Skeleton) -> None:
        self.source = GlbReader(look.shape)
        self.texture, self.skeleton = look.texture, skeleton
        self.out = GlbWriter("AHMSS")

    def write(self, motion: tuple[Array, Array, float], name: str) -> bytes:
        """The file's bytes."""
        tree = self.out.tree
        tree |= {key: self.source.tree[key] for key in _KEPT if key in self.source.tree}
        self._images()
        inverse_binds = self._inverse_binds()
        binds = self.out.add(_columns(inverse_binds))
        tree["skins"] = [{"joints": list(range(len(LINKS))), "inverseBindMatrices": binds, "skeleton": 0}]
        skinned = [node for node in self.source.tree["nodes"] if "skin" in node and "mesh" in node]
        tree["meshes"] = [self._mesh(self.source.tree["meshes"][node["mesh"]]) for node in skinned]
        joints = self._joints(inverse_binds)
        shown = [{"name": node.get("name", "shape"), "mesh": i, "skin": 0} for i, node in enumerate(skinned)]
        tree["nodes"] = joints + shown
        tree |= {"scene": 0, "scenes": [{"nodes": [0, *range(len(joints), len(joints) + len(shown))]}]}
        tree["animations"] = [self._animation(motion, name)]
        return self.out.bytes()

    def _inverse_binds(self) -> Array:
        """(43, 4, 4), joint <- the shape turned to glTF's axes."""
        stored = self.source.array(self.source.tree["skins"][0]["inverseBindMatrices"]).astype(float)
        inverse_binds: Array = stored.reshape(-1, 4, 4).swapaxes(1, 2)
        inverse_binds[:, :3, :3] = inverse_binds[:, :3, :3] @ _TURN.T
        return inverse_binds

    def _joints(self, inverse_binds: Array) -> list[Json]:
        """The 43 nodes, resting as the shape was modelled."""
        nodes: list[Json] = []
        binds = np.linalg.inv(inverse_binds)
        for link, name in enumerate(LINKS):
            bind, parent = binds[link], PARENTS[link]
            own = bind if parent < 0 else inverse_binds[parent] @ bind
            place = own[:3, 3] if parent < 0 else self.skeleton.offsets[link]
            rotation = from_matrix(own[:3, :3])[_XYZW]
            node: Json = {"name": name, "translation": _plain(place), "rotation": _plain(rotation)}
            nodes.append(node | ({"children": list(CHILDREN[link])} if CHILDREN[link] else {}))
        return nodes

    def _mesh(self, mesh: Json) -> Json:
        return mesh | {"primitives": [self._primitive(primitive) for primitive in mesh["primitives"]]}

    def _primitive(self, primitive: Json) -> Json:
        """A primitive with its arrays turned and brought over; morph targets are not."""
        attributes = {key: self._attribute(key, index) for key, index in primitive["attributes"].items()}
        out: Json = {key: value for key, value in primitive.items() if key != "targets"} | {"attributes": attributes}
        if "indices" in primitive:
            out["indices"] = self.out.add(self.source.array(primitive["indices"]), target=ELEMENT_BUFFER)
        if self.texture is not None and "TEXCOORD_0" in attributes:
            out["material"] = self._textured(primitive.get("material"))
        return out

    def _attribute(self, key: str, index: int) -> int:
        rows = self.source.array(index)
        normalized = bool(self.source.tree["accessors"][index].get("normalized", False))
        if key in _TURNED:
            rows = (rows @ _TURN.T).astype("<f4")
        elif key == "TANGENT":
            rows = np.concatenate([rows[:, :3] @ _TURN.T, rows[:, 3:]], axis=1).astype("<f4")
        elif key == "COLOR_0":
            rows, normalized = _linear(rows), True
        elif key.startswith("TEXCOORD"):
            rows, normalized = _shares(rows).astype("<f4"), False
        return self.out.add(rows, target=ARRAY_BUFFER, normalized=normalized, bounds=key == "POSITION")

    def _images(self) -> None:
        """Bring the shape's own pictures over, and add the texture that lies beside it."""
        tree = self.out.tree
        images = [dict(image) for image in tree.get("images", [])]
        for image in images:
            if "bufferView" in image:
                image["bufferView"] = self.out.add_view(self.source.view(image["bufferView"]))
        if images:
            tree["images"] = images
        if self.texture is not None:
            kind = "image/png" if self.texture.startswith(_PNG) else "image/jpeg"
            added: Json = {"bufferView": self.out.add_view(self.texture), "mimeType": kind}
            tree["images"] = [*images, added]
            tree["textures"] = [*tree.get("textures", []), {"source": len(images)}]

    def _textured(self, material: int | None) -> int:
        """The material's copy with the texture, as a new one; its number."""
        tree = self.out.tree
        base: Json = {} if material is None else tree["materials"][material]
        surface = {"metallicFactor": 0.0} | base.get("pbrMetallicRoughness", {})
        surface["baseColorTexture"] = {"index": len(tree["textures"]) - 1}
        tree["materials"] = [*tree.get("materials", []), base | {"pbrMetallicRoughness": surface}]
        return len(tree["materials"]) - 1

    def _animation(self, motion: tuple[Array, Array, float], name: str) -> Json:
        """Every joint's turning and the hips' way, a key a frame."""
        rotations, root, rate = motion
        turning = continuous(rotations)
        turning[:, 0] = multiply(_Q_TURN, turning[:, 0])
        times = self.out.add((np.arange(len(root)) / rate)[:, None].astype("<f4"), bounds=True)
        outputs = [self.out.add(turning[:, link, _XYZW].astype("<f4")) for link in range(len(LINKS))]
        outputs.append(self.out.add((root @ _TURN.T).astype("<f4")))
        paths = [(link, "rotation") for link in range(len(LINKS))] + [(0, "translation")]
        return {
            "name": name,
            "samplers": [{"input": times, "output": output, "interpolation": "LINEAR"} for output in outputs],
            "channels": [
                {"sampler": i, "target": {"node": node, "path": path}} for i, (node, path) in enumerate(paths)
            ],
        }


def _linear(colours: NDArray[Any]) -> NDArray[Any]:
    """sRGB colours (n, 3 or 4) as linear ones (n, 4) in 16 bits; alpha, the fourth, is linear already."""
    stored = _shares(colours)
    linear = np.ones((len(stored), 4))
    linear[:, : stored.shape[1]] = stored
    rgb = linear[:, :3]
    linear[:, :3] = np.where(rgb <= 0.04045, rgb / 12.92, ((rgb + 0.055) / 1.055) ** 2.4)  # IEC 61966-2-1
    return np.round(linear * 65535.0).astype("<u2")


def _shares(stored: NDArray[Any]) -> Array:
    """What normalized integers stand for, 0 to 1; floats as they are."""
    return stored / float(np.iinfo(stored.dtype).max) if stored.dtype.kind == "u" else stored.astype(float)


def _columns(matrices: Array) -> NDArray[Any]:
    """(n, 4, 4) as rows (n, 16), column by column."""
    return matrices.swapaxes(1, 2).reshape(-1, 16).astype("<f4")


def _plain(values: Array) -> list[float]:
    return [float(value) + 0.0 for value in np.round(values, 9)]
