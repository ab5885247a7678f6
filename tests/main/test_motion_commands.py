"""`ahmss motion` as it is typed: clips, files of other makers, and a recording of two humans."""

from __future__ import annotations

import json
import sys
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import msgspec
import numpy as np
import pytest

from ahmss.body.links import INDEX
from ahmss.body.quaternion import from_rotation_vector, multiply
from ahmss.cli import main
from ahmss.database.workspace import Workspace
from ahmss.motion.bvh_out import write_bvh
from ahmss.motion.clip import Clip, ClipHeader, load, save
from ahmss.motion.glbfile import GlbReader
from ahmss.world.recording import Writer
from ahmss.world.schema import HumanRecord, Scene, Snapshot, content_hash

HUMANS = Workspace(Path(__file__).parents[2]).humans
KEYS = [
    "support_speed_mean", "support_speed_p95", "slide_per_stance_cm", "alpha_max", "alpha_p99", "jerk_max", "pop_deg",
    "contact_drift_mm", "floor_penetration_mm", "joint_limit_excess_deg",
]  # fmt: skip
RATE = 60.0
Typed = Callable[..., tuple[int, str, str]]


@pytest.fixture
def typed(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path) -> Typed:
    """Type `ahmss motion ...` in a folder of its own: exit code, output, errors."""
    monkeypatch.chdir(tmp_path)

    def run(*words: object) -> tuple[int, str, str]:
        monkeypatch.setattr(sys, "argv", ["ahmss", "motion", *map(str, words)])
        try:
            main()
            code = 0
        except SystemExit as end:
            code = int(end.code or 0)
        return code, *capsys.readouterr()

    return run


def waving(name: str, seconds: float = 1.5) -> Clip:
    """A human of humandb waves the right arm twice, standing."""
    skeleton = HUMANS.get(name).skeleton
    pose, place = skeleton.relaxed()
    t = np.arange(round(seconds * RATE) + 1) / RATE
    rotations = np.repeat(pose[None], len(t), axis=0)
    arm = INDEX["right_upper_arm"]
    swing = np.stack([0.0 * t, 0.4 * np.sin(2.0 * np.pi * t / seconds), 0.0 * t], axis=-1)
    rotations[:, arm] = multiply(rotations[:, arm], from_rotation_vector(swing))
    header = ClipHeader(origin="a test", human=name)
    return Clip(
        rotations, np.repeat(place[None], len(t), 0), np.ones((len(t), 44)), np.ones((len(t), 2)), RATE, None, header
    )


@pytest.fixture
def wave(tmp_path: Path) -> Path:
    save(waving("ken"), tmp_path / "wave.npz")
    return tmp_path / "wave.npz"


@pytest.fixture
def recording(tmp_path: Path) -> Path:
    """Ken and aiko wave side by side; a third human has no pose."""
    return recorded(tmp_path / "two.rec", there=0)


def recorded(path: Path, there: int) -> Path:
    """The same; the third human is there for so many frames at the end, and stands as ken does."""
    assets: dict[str, bytes] = {}

    def put(data: bytes) -> str:
        assets[content_hash(data)] = data
        return content_hash(data)

    names = ("ken", "aiko")
    humans = [
        HumanRecord(
            i, f"{name}_1", name, skeleton=put(json.dumps(HUMANS.get(name).skeleton.to_record()).encode()),
            shape=put(HUMANS.shape(name).glb),
        )
        for i, name in enumerate((*names, "ken"), start=1)
    ]  # fmt: skip
    humans[2] = msgspec.structs.replace(humans[2], name="nobody")
    clips = [waving(name) for name in (*names, "ken")]
    writer = Writer(path, assets.get)
    for k in range(clips[0].frames):
        seen = 3 if k >= clips[0].frames - there else 2
        rows = [np.concatenate([c.root[k] + [0.0, i, 0.0], c.rotations[k].ravel()]) for i, c in enumerate(clips[:seen])]
        ids, shown = np.arange(1, seen + 1).astype("<u4").tobytes(), np.full(seen, k, "<u4").tobytes()
        poses = np.array(rows).astype("<f4").tobytes()
        writer.write(Snapshot(k, k / RATE, 1, ids, shown, poses), lambda: Scene(1, [], humans))
    writer.close()
    return path


def asked(typed: Typed, *words: object) -> Any:
    code, out, err = typed(*words)
    assert code == 0, err
    return json.loads(out)


def test_every_command_has_help_with_an_example(typed: Typed) -> None:
    _, out, _ = typed("--help")
    commands = [
        "info",
        "quality",
        "importance",
        "annotate",
        "cut",
        "mirror",
        "resample",
        "retarget",
        "import",
        "export",
    ]
    for command in commands:
        assert f"  {command} " in out
        code, text, _ = typed(command, "--help")
        assert code == 0
        assert f"Example: ahmss motion {command}" in " ".join(text.split())


def test_quality_prints_the_ten_figures_and_nothing_else(typed: Typed, wave: Path) -> None:
    figures = asked(typed, "quality", wave, "--json")
    assert list(figures) == KEYS
    assert figures["alpha_max"] == pytest.approx(0.4 * (2.0 * np.pi / 1.5) ** 2, rel=0.05)
    assert figures["contact_drift_mm"] < 0.01
    assert figures["joint_limit_excess_deg"] == 0.0
    _, out, _ = typed("quality", wave)
    assert "(right_upper_arm)" in out


def test_quality_of_a_recording_is_of_each_human_who_was_seen(typed: Typed, recording: Path, wave: Path) -> None:
    figures = asked(typed, "quality", recording, "--json")
    assert list(figures) == ["aiko_1", "ken_1"]
    alone = asked(typed, "quality", wave, "--json")
    assert list(figures["ken_1"]) == KEYS
    assert figures["ken_1"]["alpha_max"] == pytest.approx(alone["alpha_max"], rel=1e-3)
    assert figures["aiko_1"]["floor_penetration_mm"] < 1.0
    assert list(asked(typed, "quality", recording, "--human", "ken_1", "--json")) == ["ken_1"]
    code, _, err = typed("quality", recording, "--human", "eve")
    assert code == 1
    assert "there is: aiko_1, ken_1" in err


def test_who_is_in_a_recording_for_a_moment_is_left_out_of_its_quality(typed: Typed, tmp_path: Path) -> None:
    path = recorded(tmp_path / "guest.rec", there=12)
    code, out, err = typed("quality", path, "--json")
    assert code == 0
    assert list(json.loads(out)) == ["aiko_1", "ken_1"]
    assert "nobody left out: 0.18 s are too short to measure; 0.5 s at least" in err
    code, _, err = typed("quality", path, "--human", "nobody")
    assert code == 1
    assert "0.18 s are too short to measure" in err


def test_quality_of_keyframes_is_of_what_is_between_them(typed: Typed, tmp_path: Path) -> None:
    clip = waving("ken")
    header = msgspec.structs.replace(clip.header, times=(0.5, 1.0))
    keys = [0, 22]
    two = replace(
        clip, rotations=clip.rotations[keys], root=clip.root[keys], importance=clip.importance[keys],
        contacts=clip.contacts[keys], header=header,
    )  # fmt: skip
    save(two, tmp_path / "keys.npz")
    code, out, err = typed("quality", "keys.npz", "--json")
    assert code == 0
    assert "2 keyframes" in err
    assert json.loads(out)["support_speed_mean"] == 0.0


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        (("quality", "none.npz"), "no such motion"),
        (("quality", "short.npz"), "0.25 s are too short to measure"),
        (("quality", "wave.npz", "--human", "ken"), "--human names a human of a recording"),
        (("quality", "wave.npz", "--body", "eve"), 'no human "eve"'),
        (("quality", "two.rec", "--body", "ken"), "leave --body out"),
        (("cut", "wave.npz", "--to", "9"), "seconds 0 to 9 are not in the clip, which goes from 0 to 1.5"),
        (("cut", "wave.npz", "-o", "wave.npz"), "this is the file itself"),
        (("mirror", "wave.npz", "-o", "short.npz"), "it is there already"),
        (("mirror", "wave.npz", "-o", "wave.bvh"), "ahmss motion export"),
        (("resample", "wave.npz"), "one of --frames, --seconds and --rate"),
        (("resample", "wave.npz", "--frames", "10", "--rate", "10"), "one of --frames, --seconds and --rate"),
        (("resample", "wave.npz", "--frames", "0"), "--frames 0; give more than 0"),
        (("resample", "wave.npz", "--rate", "-5"), "--rate -5; give more than 0"),
        (("resample", "wave.npz", "--seconds", "nan"), "--seconds nan; give more than 0"),
        (("resample", "wave.npz", "--rate", "inf"), "at most 1000"),
        (("cut", "wave.npz", "--from", "nan"), "seconds nan to 1.5 are not in the clip"),
        (("retarget", "nobodys.npz", "--body", "aiko"), "--from"),
        (("export", "wave.npz"), "with -o"),
        (("export", "wave.npz", "-o", "wave.fbx"), ".bvh, .glb, .npz"),
        (("export", "two.rec", "-o", "a.glb"), "name one with --human: aiko_1, ken_1"),
        (("export", "nobodys.npz", "-o", "a.glb"), "--body"),
        (("import", "wave.npz"), "motion files end in"),
    ],
)
def test_what_can_not_be_done_is_one_sentence(
    typed: Typed, wave: Path, recording: Path, words: tuple[str, ...], sentence: str
) -> None:
    save(waving("ken", 0.25), wave.with_name("short.npz"))
    clip = waving("ken")
    save(replace(clip, header=msgspec.structs.replace(clip.header, human="")), wave.with_name("nobodys.npz"))
    before = {file.name: file.read_bytes() for file in wave.parent.iterdir()}
    code, _, err = typed(*words)
    assert code == 1
    assert sentence in err
    assert err.count("\n") == 1
    assert {file.name: file.read_bytes() for file in wave.parent.iterdir()} == before


def test_what_is_written_is_named_after_the_source_and_nothing_is_written_over(typed: Typed, wave: Path) -> None:
    for words, name, frames in (
        (("cut", "wave.npz", "--from", 0.5, "--to", 1.0), "wave_cut.npz", 31),
        (("mirror", "wave.npz"), "wave_mirrored.npz", 91),
        (("resample", "wave.npz", "--seconds", 3), "wave_resampled.npz", 181),
        (("retarget", "wave.npz", "--body", "aiko"), "wave_aiko.npz", 91),
        (("importance", "wave.npz", "--derive"), "wave_weighed.npz", 91),
    ):
        code, out, err = typed(*words)
        assert (code, err) == (0, "")
        assert out.startswith(f"wrote {name}: {frames} frames")
        assert load(wave.with_name(name)).frames == frames
        assert typed(*words)[0] == 1
        assert typed(*words, "--force")[0] == 0
    assert load(wave.with_name("wave_aiko.npz")).header.human == "aiko"
    assert typed("resample", "wave.npz", "--rate", 30, "-o", "sub/slow.npz")[0] == 0
    slow = load(wave.with_name("sub") / "slow.npz")
    assert (slow.rate, slow.frames) == (30.0, 46)
    assert typed("cut", "wave.npz", "--to", 1.0, "-o", "wave.npz", "--force")[0] == 0
    assert load(wave).frames == 61


def test_importance_is_shown_and_derived(typed: Typed, wave: Path) -> None:
    assert typed("importance", wave, "--derive", "-o", "own.npz")[0] == 0
    rows = asked(typed, "importance", "own.npz", "--json")
    assert len(rows) == 44
    assert rows["right_upper_arm"]["most"] > 0.8
    assert rows["left_upper_arm"]["most"] == 0.0
    assert rows["root"] == {"least": 0.0, "mean": 0.0, "most": 0.0}
    assert typed("importance", wave, "-o", "other.npz")[0] == 2  # wrong usage: nothing to write


def test_a_table_is_added(typed: Typed, wave: Path) -> None:
    table = wave.with_name("wave.toml")
    table.write_text("[[importance]]\njoints = { head = 0.25 }\n", encoding="utf-8")
    code, out, err = typed("annotate", "wave.npz", "wave.toml")
    assert (code, err) == (0, "")
    assert "wave_annotated.npz" in out
    assert asked(typed, "importance", "wave_annotated.npz", "--json")["head"]["mean"] == pytest.approx(0.25)


def test_info_tells_of_clips_and_recordings(typed: Typed, wave: Path, recording: Path) -> None:
    told = asked(typed, "info", wave, "--json")
    assert (told["frames"], told["human"], told["standing"]) == (91, "ken", [1.0, 1.0])
    assert "turns most, degrees: right_upper_arm" in typed("info", wave)[1]
    assert list(asked(typed, "info", recording, "--json")) == ["aiko_1", "ken_1"]


def test_what_is_exported_as_bvh_comes_back(typed: Typed, wave: Path) -> None:
    assert typed("export", "wave.npz", "-o", "wave.bvh")[0] == 0
    code, out, _ = typed("import", "wave.bvh", "--body", "ken", "-o", "back.npz")
    assert code == 0
    assert "unit taken to be m" in out
    back, clip = load(wave.with_name("back.npz")), load(wave)
    arm = INDEX["right_upper_arm"]
    away = np.abs(np.einsum("fc,fc->f", back.rotations[:, arm], clip.rotations[:, arm]))
    assert back.frames == clip.frames
    assert np.degrees(2.0 * np.arccos(np.minimum(away, 1.0))).max() < 3.0
    assert asked(typed, "quality", "wave.bvh", "--json")["alpha_max"] == pytest.approx(
        asked(typed, "quality", "wave.npz", "--json")["alpha_max"], rel=1e-2
    )


def test_one_human_out_of_a_recording_is_exported_with_their_own_looks(typed: Typed, recording: Path) -> None:
    for ending in ("glb", "bvh", "npz"):
        code, out, err = typed("export", recording, "--human", "aiko_1", "-o", f"aiko.{ending}")
        assert (code, err) == (0, "")
        assert "91 frames of aiko" in out
    file = GlbReader(recording.with_name("aiko.glb").read_bytes())
    root = file.array(file.tree["animations"][0]["samplers"][43]["output"])
    assert np.allclose(root[:, 0], 1.0, atol=1e-6)  # she stands a metre to the left, which is x there
    stands = file.tree["accessors"][file.tree["meshes"][0]["primitives"][0]["attributes"]["POSITION"]]
    assert stands["count"] == 8750
    clip = load(recording.with_name("aiko.npz"))
    assert clip.header.human == "aiko"
    assert np.allclose(clip.root[0, :2], 0.0, atol=1e-6)  # a clip begins at its human's own place


def test_a_file_of_another_maker_becomes_glb_at_once(typed: Typed, wave: Path) -> None:
    clip, skeleton = load(wave), HUMANS.get("ken").skeleton
    write_bvh(wave.with_name("wave.bvh"), skeleton, clip.rotations, clip.root, clip.rate)
    assert typed("export", "wave.bvh", "--body", "aiko", "-o", "wave.glb")[0] == 0
    tree = GlbReader(wave.with_name("wave.glb").read_bytes()).tree
    assert tree["nodes"][43]["name"] == "aiko"
