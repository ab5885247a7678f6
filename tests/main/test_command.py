import pytest
from hypothesis import given
from hypothesis import strategies as st

from ahmss.errors import CommandError
from ahmss.main.command import Act, Add, Do, Human, Line, Remove, Set, Sync, Wait, expected, parse


@pytest.mark.parametrize(
    ("text", "line"),
    [
        ("add cup", Add("cup")),
        ("add cup as mug at 1 2", Add("cup", "mug", (1.0, 2.0, 0.0))),
        ("add cup at 1 2 .75 facing -90  # left", Add("cup", "", (1.0, 2.0, 0.75), -90.0)),
        ("remove room/cup", Remove("room/cup")),
        ("set lamp power on", Set("lamp", "power", "on")),
        ("set panel/dial turn 0.5", Set("panel/dial", "turn", 0.5)),
        ('set sign text "12"', Set("sign", "text", "12")),
        ("human ken", Human("ken")),
        ("human ken body tall at 0 1 facing 90", Human("ken", "tall", (0.0, 1.0), 90.0)),
        ("do cup grasp", Do((Act("cup", "grasp"),))),
        (
            "do cup grasp frames 60 after 20 with television look",
            Do((Act("cup", "grasp", frames=60, after=20), Act("television", "look"))),
        ),
        ("ken: do door open frames 180", Do((Act("door", "open", frames=180),), "ken")),
        (
            "do floor walk to 2 1 facing 90",
            Do((Act("floor", "walk", goal_place=(2.0, 1.0), facing_deg=90.0),)),
        ),
        (
            "do floor walk to cup with cup reach after 40",
            Do((Act("floor", "walk", goal_object="cup"), Act("cup", "reach", after=40))),
        ),
        ("do at 0.4 0.2 0.8 grasp", Do((Act("", "grasp", object_place=(0.4, 0.2, 0.8)),))),
        ("do cup put at 1 0 0.7", Do((Act("cup", "put", goal_place=(1.0, 0.0, 0.7)),))),
        (
            "do cup grasp hand left diameter=0.07 style = s pose a.npz",
            Do((Act("cup", "grasp", hand="left", posture="a.npz", parameters=(("diameter", 0.07), ("style", "s"))),)),
        ),
        ('do "hand" "with"', Do((Act("hand", "with"),))),
        ("wait 1.5", Wait(1.5)),
        ("aiko: wait lamp power == on", Wait(0.0, "lamp", "power", "==", "on", "aiko")),
        ("wait door angle >= 0.4", Wait(0.0, "door", "angle", ">=", 0.4)),
        ("wait door angle >= 0.4 within 20", Wait(0.0, "door", "angle", ">=", 0.4, within=20.0)),
        ("sync", Sync()),
        ("", None),
        ("   # only a comment", None),
    ],
)  # fmt: skip
def test_each_production_is_read(text: str, line: Line | None) -> None:
    assert parse(text) == line


@pytest.mark.parametrize(
    ("text", "error"),
    [
        ("jump", 'column 1: "jump" can\'t stand here; expected: `do` or `add` or `wait` or `set` or `human`'),
        ("do cup", "column 7: the line ends here; expected: an action"),
        ("do cup with television look", 'column 8: "with" can\'t stand here; expected: an action'),
        ("do cup grasp frames 0", 'column 21: "0" can\'t stand here; expected: a whole number from 1 to 1000000'),
        ("do cup grasp frames 1.5", 'column 21: "1.5" can\'t stand here; expected: a whole number from 1 to 1000000'),
        ("do cup grasp frames many", 'column 21: "many" can\'t stand here; expected: a number of frames'),
        ("do cup grasp hand middle", 'column 19: "middle" can\'t stand here; expected: `left` or `right`'),
        ("do cup grasp frames 2 frames 3", 'column 23: "frames" can\'t stand here; expected: only one frames'),
        ("do cup put to 1 2 at 3 4", 'column 19: "at" can\'t stand here; expected: only one goal for each action'),
        ("add cup at 1", "column 13: the line ends here; expected: a number (y in metres)"),
        ("add cup at 1 nan", 'column 14: "nan" can\'t stand here; expected: a number (y in metres)'),
        (
            "wait banana",
            'column 6: "banana" can\'t stand here; expected: a number (seconds), or an object with a state of it, '
            "as in `wait banana STATE == VALUE`",
        ),
        ("wait -1", 'column 6: "-1" can\'t stand here; expected: seconds that are not negative'),
        (
            "wait lamp power on",
            'column 17: "on" can\'t stand here; expected: `==` or `!=` or `<` or `<=` or `>` or `>=`',
        ),
        ("ken: add cup", 'column 6: "add" can\'t stand here; expected: `do` or `wait`'),
        ("sync now", 'column 6: "now" can\'t stand here; expected: the end of the line'),
        ('do "cup grasp', "column 4: this quote is not closed"),
        ("do cup grasp!", "column 13: no word has a '!'"),
        ("remove =", 'column 8: "=" can\'t stand here; expected: an object'),
        ('remove ""', 'column 8: "" can\'t stand here; expected: an object'),
    ],
)
def test_an_error_says_where_and_what_is_allowed(text: str, error: str) -> None:
    with pytest.raises(CommandError) as caught:
        parse(text, "table.txt:3: ")
    assert str(caught.value).startswith(f"table.txt:3: {error}")


@pytest.mark.parametrize(
    ("text", "what"),
    [
        ("", {"do", "add", "wait", "set", "human", "remove", "sync"}),
        ("do ", {"at", "OBJECT"}),
        ("do cup ", {"ACTION"}),
        ("do cup grasp ", {"to", "at", "facing", "hand", "pose", "frames", "after", "with", "then", "KEY=VALUE"}),
        ("do cup grasp hand ", {"left", "right"}),
        ("do cup grasp to ", {"X", "OBJECT"}),
        ("add ", {"KIND"}),
        ("ken: ", {"do", "wait"}),
        ("do cup grasp frames x ", set()),
    ],
)
def test_completion_knows_what_may_follow(text: str, what: set[str]) -> None:
    assert set(expected(text)[0]) == what


@given(st.text(max_size=60))
def test_any_text_is_read_or_refused_in_one_sentence(text: str) -> None:
    try:
        parse(text)
        reason = ""
    except CommandError as error:
        reason = str(error)
    assert len(reason.strip().splitlines()) <= 1
    expected(text)
