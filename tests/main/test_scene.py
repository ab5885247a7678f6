"""Several humans in real time: what one of them adds before a `sync` is there for all after it."""

from pathlib import Path

import pytest

from ahmss.main.play import PlaySetup, play_script

pytestmark = pytest.mark.usefixtures("pool")


def test_nobody_begins_before_the_scene_has_come(workspace: Path, tmp_path: Path) -> None:
    names = [f"h{i}" for i in range(4)]
    lines = [f"human {name} body ken at 0 {i}" for i, name in enumerate(names)]
    lines += [f"add box as b{i} at 0.3 {i} 1" for i in range(8)]
    lines += [f"{name}: do b{i} wave frames 10" for i, name in enumerate(names)]
    script = tmp_path / "many.txt"
    script.write_text("\n".join(lines) + "\n")
    report = play_script(script, PlaySetup(workspace=workspace))
    assert [main["messages"] for main in report.mains] == [[]] * len(names)
