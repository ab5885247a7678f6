"""What a human model sends is read by the dialogue's grammar: each act becomes the line that means it."""

from __future__ import annotations

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from ahmss.errors import CommandError
from ahmss.main import command
from ahmss.port.acts import act
from ahmss.port.grammar import line_of
from ahmss.port.schema import Act

NAMES = st.text(
    st.characters(codec="utf-8", exclude_characters='"\n\r\x0b\x0c\x1c\x1d\x1e\x85\u2028\u2029'), min_size=1
)
NUMBERS = st.integers(-2_000_000, 2_000_000).map(lambda n: n / 1000.0)
PLACES = st.lists(NUMBERS, min_size=2, max_size=3).map(tuple)
ACTS = st.builds(
    Act,
    object=NAMES,
    action=NAMES,
    to=st.just(()) | PLACES,
    facing_deg=st.none() | NUMBERS,
    hand=st.sampled_from(["", "left", "right"]),
    pose=st.just("") | NAMES,
    parameters=st.dictionaries(NAMES, NUMBERS | NAMES, max_size=2),
    frames=st.none() | st.integers(1, 1_000_000),
    after=st.integers(0, 1_000_000),
)


def read(acts: list[Act]) -> tuple[command.Act, ...]:
    line = command.parse(line_of(acts))
    assert isinstance(line, command.Do)
    return line.acts


@given(ACTS)
def test_every_act_comes_back_from_its_line_as_it_was_sent(sent: Act) -> None:
    (came,) = read([sent])
    assert (came.object, came.action, came.hand, came.posture) == (sent.object, sent.action, sent.hand, sent.pose)
    assert (came.frames, came.after) == (sent.frames, sent.after)
    assert came.goal_place == pytest.approx(sent.to)
    assert (came.facing_deg is None) == (sent.facing_deg is None)
    assert came.facing_deg is None or came.facing_deg == pytest.approx(sent.facing_deg)
    assert [key for key, _ in came.parameters] == list(sent.parameters)
    for key, value in came.parameters:
        wanted = sent.parameters[key]
        assert value == (wanted if isinstance(wanted, str) else pytest.approx(wanted))


def test_a_name_that_is_a_keyword_or_a_number_is_quoted_and_a_plain_one_is_not() -> None:
    assert line_of([Act("cup", "reach")]) == "do cup reach"
    assert line_of([Act("to", "3", to_object="then")]) == 'do "to" "3" to "then"'


@pytest.mark.parametrize("text", ["0.2 -0.9", "0.2, -0.9"])
def test_a_text_of_numbers_is_a_place_as_the_dialogue_takes_it(text: str) -> None:
    assert act("floor", "walk", to=text) == act("floor", "walk", to=(0.2, -0.9))
    assert act(text, "look") == act((0.2, -0.9), "look")
    assert act("3", "look", to="gauge 3") == Act("3", "look", to_object="gauge 3")


def test_acts_are_fused_or_follow_each_other_and_an_object_may_be_named_by_its_place() -> None:
    acts = [Act(at=(0.4, -0.1, 0.9), action="grasp"), Act("tv", "look", after=12), Act("tv", "press", follows=True)]
    assert line_of(acts) == "do at 0.4 -0.1 0.9 grasp with tv look after 12 then tv press"
    came = read(acts)
    assert came[0].object_place == (0.4, -0.1, 0.9)
    assert [act.follows for act in came] == [False, False, True]


@pytest.mark.parametrize(
    ("act", "says"),
    [
        (Act("cup", "reach", frames=0), "a whole number from 1"),
        (Act("cup", "reach", after=-1), "a whole number from 0"),
        (Act("cup", "reach", hand="both"), "`left` or `right`"),
        (Act("cup", "reach", to=(math.nan, 1.0)), "finite numbers in metres"),
        (Act("cup", ""), "an action"),
        (Act("", "reach"), "an object"),
    ],
)
def test_what_the_grammar_does_not_allow_is_refused_with_what_it_does(act: Act, says: str) -> None:
    with pytest.raises(CommandError, match=says):
        command.parse(line_of([act]))


def test_nothing_to_do_and_a_name_with_both_quotes_are_said_to_be_so() -> None:
    with pytest.raises(CommandError, match="as in: do door open"):
        line_of([])
    with pytest.raises(CommandError, match="both kinds of quotes"):
        line_of([Act("a\"b'c", "open")])
