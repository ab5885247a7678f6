from collections.abc import Sequence

import pytest

from ahmss.errors import CommandError
from ahmss.main.command import Act, Add, Do, Line, Set
from ahmss.main.dialogue import Dialogue, Listing
from ahmss.main.terminal import PersonsTerminal


class Shelf:
    """A catalogue of two objects."""

    def objects(self) -> Listing:
        return Listing("objects", (("room/cup", "a cup"), ("room/floor", "a floor")))

    def actions(self, name: str) -> Listing:
        actions = {
            "room/cup": (("grasp", "take it"),),
            "room/floor": (("walk", "walk on it"), ("stroll", "walk as long as it takes")),
        }
        return Listing("actions", actions[name])

    def kinds(self) -> Listing:
        return Listing("kinds", (("cup", "a cup"), ("lamp", "a lamp")))

    def asks(self, name: str, action: str) -> tuple[Sequence[str], int]:
        known = {"walk": (("goal_position", "facing"), 120), "stroll": (("goal_position",), 0)}
        return known.get(action, (("hand",), 60)) if name == "room/floor" else (("hand",), 60)


@pytest.fixture
def dialogue() -> Dialogue:
    return Dialogue(Shelf())


def talk(dialogue: Dialogue, *answers: str) -> tuple[list[str], Line | None]:
    asked: list[str] = []
    line = None
    for answer in answers:
        asked.append(dialogue.question.prompt.split(" (")[0])
        line = dialogue.answer(answer)
    return asked, line


def test_the_steps_of_a_motion_are_those_of_the_thesis(dialogue: Dialogue) -> None:
    asked, line = talk(dialogue, "floor", "walk", "2 1", "90", "200", "no")
    assert asked == [
        "object", "what to do with room/floor", "goal position", "facing at the goal", "number of frames",
        "fuse with another motion?",
    ]  # fmt: skip
    assert line == Do((Act("room/floor", "walk", goal_place=(2.0, 1.0), facing_deg=90.0, frames=200),))


def test_an_action_without_a_number_of_frames_takes_as_many_as_it_needs(dialogue: Dialogue) -> None:
    talk(dialogue, "floor", "stroll", "2 1")
    assert dialogue.question.prompt == "number of frames (nothing for as many as it needs)"
    _, line = talk(dialogue, "", "no")
    assert line == Do((Act("room/floor", "stroll", goal_place=(2.0, 1.0)),))


def test_fusing_goes_back_to_the_objects_and_asks_when_to_start(dialogue: Dialogue) -> None:
    asked, line = talk(dialogue, "floor", "walk", "cup", "", "", "yes", "40", "cup", "grasp", "left", "50", "no")
    assert asked[6:8] == ["start the next motion after how many frames", "object"]
    assert line == Do(
        (
            Act("room/floor", "walk", goal_object="room/cup"),
            Act("room/cup", "grasp", hand="left", frames=50, after=40),
        )
    )


def test_an_object_is_added_by_kind_position_and_orientation(dialogue: Dialogue) -> None:
    asked, line = talk(dialogue, "add", "lamp", "1, 2", "45")
    assert asked[1:] == ["object to add", "position", "orientation"]
    assert line == Add("lamp", "", (1.0, 2.0, 0.0), 45.0)


def test_undo_takes_back_one_answer_at_a_time(dialogue: Dialogue) -> None:
    talk(dialogue, "cup", "grasp", "left")
    assert dialogue.undo()
    assert dialogue.question.prompt.startswith("hand")
    assert dialogue.undo()
    assert dialogue.undo()
    assert dialogue.question.prompt == "object"
    assert not dialogue.undo()


def test_a_whole_line_serves_at_any_question_and_keeps_it(dialogue: Dialogue) -> None:
    dialogue.answer("cup")
    assert dialogue.answer("set lamp power on") == Set("lamp", "power", "on")
    assert dialogue.answer("ken: do cup grasp") == Do((Act("cup", "grasp"),), "ken")
    assert dialogue.question.prompt == "what to do with room/cup"


def test_a_whole_motion_leaves_the_one_that_was_asked_about(dialogue: Dialogue) -> None:
    talk(dialogue, "cup", "grasp", "left")
    assert dialogue.answer("do floor walk to cup") == Do((Act("floor", "walk", goal_object="cup"),))
    assert dialogue.question.prompt == "object"
    assert not dialogue.undo()


@pytest.mark.parametrize(
    ("answers", "error"),
    [
        (["cpu"], 'no object "cpu"; did you mean cup?'),
        (["stroll"], "as in: do floor stroll to cup"),
        (["stroll to cup"], "actions are done by `do OBJECT ACTION`, as in: do floor stroll to cup"),
        (["cup grasp"], 'no object "cup grasp"; actions are done by `do OBJECT ACTION`, as in: do cup grasp'),
        (["grasp cup"], "as in: do cup grasp"),
        (["cup", "throw"], 'no action of room/cup "throw"; there are: grasp'),
        (["floor", "walk", "1"], 'no place x y [z] and no object "1"'),
        (["floor", "walk", "1 2", "north"], '"north" is no degrees'),
        (["cup", "grasp", "", "0"], '"0" is no number of frames; allowed: 1 to 1000000'),
        (["cup", "grasp", "", "", "perhaps"], '"perhaps" is neither yes nor no'),
        (["add", "lamp", "1 nan"], '"1 nan" is no x y [z]'),
    ],
)
def test_a_wrong_answer_is_refused_and_asked_again(dialogue: Dialogue, answers: list[str], error: str) -> None:
    talk(dialogue, *answers[:-1])
    question = dialogue.question
    with pytest.raises(CommandError) as caught:
        dialogue.answer(answers[-1])
    assert error in str(caught.value)
    assert str(caught.value).endswith("(`undo` goes back)") == (len(answers) > 1)
    assert dialogue.question == question


def test_an_object_is_named_by_as_many_of_its_last_parts_as_it_takes() -> None:
    class Panels(Shelf):
        def objects(self) -> Listing:
            names = ("room/panel/lever_5", "room/desk/lever_5", "room/desk")
            return Listing("objects", tuple((name, "a thing") for name in names))

        def actions(self, name: str) -> Listing:
            return Listing("actions", (("slide", f"slide {name}"),))

    dialogue = Dialogue(Panels())
    with pytest.raises(CommandError, match='which "lever_5"'):
        dialogue.answer("lever_5")
    with pytest.raises(CommandError, match='no object "esk/lever_5"'):
        dialogue.answer("esk/lever_5")
    dialogue.answer("panel/lever_5")
    assert dialogue.question.prompt == "what to do with room/panel/lever_5"


def test_on_a_terminal_names_are_shown_whole_however_long_the_sentences_are(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("COLUMNS", "100")
    names = ["control_room/panel/annunciator_window_2", "control_room/desk/telephone/handset", "aiko"]
    PersonsTerminal(None).show(Listing("objects", tuple((name, "A sentence of many words. " * 6) for name in names)))
    shown = capsys.readouterr().out
    assert all(f"  {name} " in shown for name in names)
    assert max(map(len, shown.splitlines())) <= 100


def test_a_long_sentence_is_broken_between_words(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("COLUMNS", "40")
    words = 'no kind of object "cpu"; allowed: annunciator, bookshelf, castor_chair, control_room, key_switch'
    PersonsTerminal(None).say(words)
    told = capsys.readouterr().out
    assert max(map(len, told.splitlines())) <= 40
    assert told.split() == words.split()
