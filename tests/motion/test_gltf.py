"""A human and a motion as GLB: played as the format says, and read by the programs that are on this machine."""

from __future__ import annotations

import io
import json
import shutil
import subprocess
import tempfile
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from ahmss.body.kinematics import forward
from ahmss.body.links import INDEX, LINKS
from ahmss.body.quaternion import to_matrix
from ahmss.database.workspace import Workspace
from ahmss.errors import CommandError, DataError, ProtocolError
from ahmss.motion.clip import Clip
from ahmss.motion.exporting import export
from ahmss.motion.glbfile import GlbReader, GlbWriter
from ahmss.motion.gltf import Look, animated

HUMANS = Workspace(Path(__file__).parents[2]).humans
BLENDER_READS = Path(__file__).with_name("blender_reads.py")
VALIDATE = """
const {validateBytes} = require('gltf-validator');
const {readFileSync} = require('fs');
validateBytes(new Uint8Array(readFileSync(process.argv[1]))).then(r => console.log(JSON.stringify(r)));
"""


def look(name):
    return Look(HUMANS.get(name).shape.read_bytes())


def motion(name, swing):
    """The swing of an arm on a human of humandb, who also turns and goes: rotations, root, rate."""
    skeleton = HUMANS.get(name).skeleton
    return swing.rotations, swing.root + skeleton.upright()[1] * (0.0, 0.0, 1.0), swing.rate


def to_gltf(places):
    """Our x ahead, y left, z up as glTF's z ahead, x left, y up."""
    return np.stack([places[..., 1], places[..., 2], places[..., 0]], axis=-1)


class Played:
    """A GLB played by the letter of the format, as any program would."""

    def __init__(self, data):
        self.file = GlbReader(data)
        self.tree = self.file.tree
        self.nodes = self.tree["nodes"]
        (self.animation,) = self.tree["animations"]
        parents = {child: i for i, node in enumerate(self.nodes) for child in node.get("children", ())}
        self.parents = [parents.get(i, -1) for i in range(len(self.nodes))]

    def matrices(self, key):
        """World matrices of all nodes (n, 4, 4) at a key of the animation."""
        trs = [{k: np.array(node[k]) for k in ("translation", "rotation") if k in node} for node in self.nodes]
        for channel in self.animation["channels"]:
            output = self.file.array(self.animation["samplers"][channel["sampler"]]["output"])
            trs[channel["target"]["node"]][channel["target"]["path"]] = output[key].astype(float)
        world = []
        for i, parent in enumerate(self.parents):
            own = np.eye(4)
            own[:3, 3] = trs[i].get("translation", np.zeros(3))
            x, y, z, w = trs[i].get("rotation", np.array([0.0, 0.0, 0.0, 1.0]))
            own[:3, :3] = to_matrix(np.array([w, x, y, z]))
            world.append(own if parent < 0 else world[parent] @ own)
        return np.array(world)

    def vertices(self, key):
        """The skin's vertices (n, 3) at a key."""
        skin = self.tree["skins"][0]
        binds = self.file.array(skin["inverseBindMatrices"]).reshape(-1, 4, 4).swapaxes(1, 2).astype(float)
        attributes = self.tree["meshes"][0]["primitives"][0]["attributes"]
        weights = self.file.array(attributes["WEIGHTS_0"]) / 255.0
        joints, places = self.file.array(attributes["JOINTS_0"]), self.file.array(attributes["POSITION"]).astype(float)
        moves = np.einsum("vk,vkij->vij", weights, (self.matrices(key)[skin["joints"]] @ binds)[joints])
        return np.einsum("vij,vj->vi", moves[:, :3, :3], places) + moves[:, :3, 3]


@pytest.mark.parametrize("name", ["aiko", "ken"])
def test_joints_are_where_forward_kinematics_has_them(name, swing):
    skeleton = HUMANS.get(name).skeleton
    rotations, root, rate = motion(name, swing)
    played = Played(animated(look(name), skeleton, (rotations, root, rate), "swing"))
    places, world = forward(rotations, root, skeleton.offsets)
    assert [node["name"] for node in played.nodes[:43]] == list(LINKS)
    times = played.file.array(played.animation["samplers"][0]["input"])[:, 0]
    assert np.allclose(times, np.arange(61) / 60.0)
    for key in (0, 17, 60):
        matrices = played.matrices(key)[:43]
        assert np.allclose(matrices[:, :3, 3], to_gltf(places[key]), atol=1e-6)
        axes = np.moveaxis(to_gltf(np.moveaxis(to_matrix(world[key]), -1, -2)), -1, -2)
        assert np.allclose(matrices[:, :3, :3], axes, atol=1e-6)


def test_a_human_who_stands_is_as_tall_as_they_are_and_looks_along_z(swing):
    skeleton = HUMANS.get("ken").skeleton
    pose, root = skeleton.relaxed()
    played = Played(animated(look("ken"), skeleton, (pose[None], root[None], 60.0), "stand"))
    skin = played.vertices(0)
    assert skin[:, 1].min() == pytest.approx(0.0, abs=0.003)
    assert skin[:, 1].max() == pytest.approx(skeleton.stature, abs=0.01)
    feet = skin[skin[:, 1] < 0.03]
    assert feet[:, 2].max() > 0.15 > -feet[:, 2].min()  # toes reach farther than heels
    assert played.matrices(0)[INDEX["left_hand"], 0, 3] > 0.1  # left is x
    bound = played.tree["accessors"][played.tree["meshes"][0]["primitives"][0]["attributes"]["POSITION"]]
    assert bound["max"][1] == pytest.approx(skeleton.stature, abs=0.01)  # upright at rest too


def test_joints_rest_in_the_pose_that_the_shape_was_modelled_in(swing):
    data = animated(look("aiko"), HUMANS.get("aiko").skeleton, motion("aiko", swing), "swing")
    played = Played(data)
    played.animation["channels"].clear()
    attributes = played.tree["meshes"][0]["primitives"][0]["attributes"]
    assert np.allclose(played.vertices(0), played.file.array(attributes["POSITION"]), atol=1e-4)


def test_colours_become_linear(swing):
    skeleton = HUMANS.get("ken").skeleton
    before = GlbReader(look("ken").shape)
    after = GlbReader(animated(look("ken"), skeleton, motion("ken", swing), "swing"))
    srgb, linear = (
        file.array(file.tree["meshes"][0]["primitives"][0]["attributes"]["COLOR_0"]) for file in (before, after)
    )
    assert linear.dtype == np.uint16
    for value, known in ((0, 0.0), (10, 0.003035), (128, 0.215861), (188, 0.502886), (255, 1.0)):
        rows, columns = np.nonzero(np.abs(srgb[:, :3].astype(int) - value) == 0)
        assert np.allclose(linear[rows, columns] / 65535.0, known, atol=1e-4)
    assert (linear[:, 3] == 65535).all()


def textured_shape():
    """One triangle on 43 joints, with picture coordinates in bytes and colours without alpha."""
    writer = GlbWriter("a test")
    attributes = {
        "POSITION": writer.add(np.eye(3, dtype="<f4"), bounds=True),
        "TEXCOORD_0": writer.add(np.array([[0, 0], [255, 0], [0, 255]], "u1"), normalized=True),
        "COLOR_0": writer.add(np.array([[255, 0, 0]] * 3, "u1"), normalized=True),
        "JOINTS_0": writer.add(np.zeros((3, 4), "u1")),
        "WEIGHTS_0": writer.add(np.array([[1.0, 0.0, 0.0, 0.0]] * 3, "<f4")),
    }
    indices = writer.add(np.array([[0], [1], [2]], "<u2"))
    binds = writer.add(np.tile(np.eye(4, dtype="<f4").reshape(1, 16), (43, 1)))
    writer.tree |= {
        "nodes": [{"name": name} for name in LINKS] + [{"mesh": 0, "skin": 0}],
        "skins": [{"joints": list(range(43)), "inverseBindMatrices": binds}],
        "meshes": [{"primitives": [{"attributes": attributes, "indices": indices}]}],
    }
    return writer.bytes()


def test_the_texture_beside_a_shape_goes_into_the_file(skeleton, swing):
    picture = io.BytesIO()
    Image.new("RGB", (4, 4), (10, 200, 30)).save(picture, "PNG")
    data = animated(Look(textured_shape(), picture.getvalue()), skeleton, (swing.rotations, swing.root, 60.0), "swing")
    file = GlbReader(data)
    (primitive,) = file.tree["meshes"][0]["primitives"]
    texture = file.tree["materials"][primitive["material"]]["pbrMetallicRoughness"]["baseColorTexture"]["index"]
    image = file.tree["images"][file.tree["textures"][texture]["source"]]
    assert image["mimeType"] == "image/png"
    assert file.view(image["bufferView"]) == picture.getvalue()
    assert file.array(primitive["attributes"]["TEXCOORD_0"]).tolist() == [[0, 0], [1, 0], [0, 1]]
    assert file.array(primitive["attributes"]["COLOR_0"]).tolist() == [[65535, 0, 0, 65535]] * 3
    assert errors_of(data) == []


def test_the_same_motion_gives_the_same_bytes(swing):
    skeleton = HUMANS.get("ken").skeleton
    assert animated(look("ken"), skeleton, motion("ken", swing), "a") == animated(
        look("ken"), skeleton, motion("ken", swing), "a"
    )


@pytest.mark.parametrize("shape", [b"", b"glTF", b"solid box", b"glTF\x02\0\0\0\x14\0\0\0\0\0\0\0JSON"])
def test_what_is_no_glb_is_one_sentence(shape, skeleton, swing, tmp_path):
    with pytest.raises(ProtocolError, match="GLB"):
        animated(Look(shape), skeleton, (swing.rotations, swing.root, 60.0), "swing")
    with pytest.raises(DataError, match=r"swing\.glb: the shape of human can't be used"):
        export(tmp_path / "swing.glb", swing, skeleton, Look(shape))


def test_an_export_needs_an_ending_that_is_known_and_a_shape_for_glb(skeleton, swing, tmp_path):
    with pytest.raises(CommandError, match=r"\.bvh, \.glb, \.npz"):
        export(tmp_path / "swing.fbx", swing, skeleton, None)
    with pytest.raises(CommandError, match="--body"):
        export(tmp_path / "swing.glb", swing, skeleton, None)
    (tmp_path / "file").write_text("")
    with pytest.raises(DataError, match="can't be written"):
        export(tmp_path / "file" / "swing.bvh", swing, skeleton, None)


def errors_of(data):
    """What the Khronos validator finds wrong; the test is skipped where it is missing."""
    node = shutil.which("node")
    if node is None:
        pytest.skip("no node on this machine to run the Khronos validator")
    there = subprocess.run([node, "-e", "require.resolve('gltf-validator')"], capture_output=True, check=False)
    if there.returncode:
        pytest.skip(
            "no Khronos validator: `npm install gltf-validator` somewhere and name its node_modules in NODE_PATH"
        )
    with tempfile.NamedTemporaryFile(suffix=".glb") as file:
        file.write(data)
        file.flush()
        done = subprocess.run([node, "-e", VALIDATE, file.name], capture_output=True, check=True, timeout=50)
    issues = json.loads(done.stdout)["issues"]
    return [message for message in issues["messages"] if message["severity"] < 2]  # errors and warnings


@pytest.mark.parametrize("name", ["aiko", "ken"])
def test_the_khronos_validator_finds_nothing_wrong(name, swing):
    assert errors_of(animated(look(name), HUMANS.get(name).skeleton, motion(name, swing), "swing")) == []


@pytest.mark.long
@pytest.mark.parametrize("name", ["aiko", "ken"])
@pytest.mark.parametrize(("ending", "first", "step"), [(".glb", 0.0, 24.0), (".bvh", 1.0, 60.0)])
def test_blender_has_every_joint_where_it_is(name, ending, first, step, swing, tmp_path):
    """Blender puts z up and what looks ahead along -y; it plays a GLB at 24 frames/s from 0, a BVH from frame 1."""
    blender = shutil.which("blender")
    if blender is None:
        pytest.skip("no Blender on this machine")
    skeleton = HUMANS.get(name).skeleton
    rotations, root, rate = motion(name, swing)
    clip = Clip(rotations, root, swing.importance, swing.contacts, rate)
    file, out = tmp_path / f"swing{ending}", tmp_path / "joints.json"
    export(file, clip, skeleton, look(name))
    seconds = [0.0, 0.25, 0.5, 1.0]
    frames = [str(first + step * second) for second in seconds]
    command = [blender, "-b", "-noaudio", "--factory-startup", "--python", BLENDER_READS, "--", file, out, *frames]
    done = subprocess.run(command, capture_output=True, text=True, check=False, timeout=50)
    assert out.exists(), done.stdout + done.stderr
    seen = json.loads(out.read_text())
    places, _ = forward(rotations, root, skeleton.offsets)
    for second, joints in zip(seconds, seen, strict=True):
        x, y, z = places[round(second * rate)].T
        expected = np.stack([y, -x, z], axis=-1)
        assert np.allclose([joints[link] for link in LINKS], expected, atol=1e-4)
