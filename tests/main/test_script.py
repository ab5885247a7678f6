from pathlib import Path

import pytest

from ahmss.errors import CommandError
from ahmss.main.command import Act, Do, Sync
from ahmss.main.script import read_script

TWO = """
human ken at 0 0
human aiko at 1 0 facing 180
add cup            # the scene
ken: do cup grasp
set lamp power on
sync
aiko: do door open
wait 1
"""


def write(directory: Path, text: str) -> Path:
    path = directory / "play.txt"
    path.write_text(text)
    return path


def test_each_human_gets_its_part_and_the_first_one_the_world(tmp_path: Path) -> None:
    script = read_script(write(tmp_path, TWO))
    assert [type(step.line).__name__ for step in script.part_of("ken")] == ["Add", "Sync", "Do", "Set", "Sync", "Wait"]
    aiko = script.part_of("aiko")
    assert [(step.number, step.line) for step in aiko[:3]] == [
        (0, Sync()),
        (7, Sync()),
        (8, Do((Act("door", "open"),), "aiko")),
    ]


def test_one_human_needs_no_name_and_no_sync_of_the_scene(tmp_path: Path) -> None:
    script = read_script(write(tmp_path, "human ken\nadd cup\ndo cup grasp\n"))
    assert [type(step.line).__name__ for step in script.part_of("ken")] == ["Add", "Do"]


@pytest.mark.parametrize(
    ("text", "error"),
    [
        ("do cup grasp", "play.txt: no human acts in it"),
        ("human a\nhuman a", 'play.txt:2: there is a human "a" already'),
        ("human a\nb: do cup grasp", 'play.txt:2: no human "b" in this script; it has: a'),
        ("human a\nhuman b\ndo cup grasp", "play.txt:3: who? begin the line with one of: a:, b:"),
        ("human a\ndo cup", "play.txt:2: column 7: the line ends here; expected: an action"),
    ],
)
def test_a_wrong_script_is_refused_with_its_place(tmp_path: Path, text: str, error: str) -> None:
    with pytest.raises(CommandError) as caught:
        read_script(write(tmp_path, text))
    assert error in str(caught.value)


def test_a_file_that_is_no_script_is_refused(tmp_path: Path) -> None:
    (tmp_path / "a.txt").write_bytes(b"\xff\xfe\x00")
    for name, reason in (("a.txt", "it is not UTF-8 text"), ("b.txt", "No such file or directory")):
        with pytest.raises(CommandError, match=reason):
            read_script(tmp_path / name)
