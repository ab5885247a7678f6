"""The thesis's table 5.9, and where its actions are found in what was played."""

from __future__ import annotations

import pytest

from ahmss.bench.survey import ACTIONS, MEAN, TRANSITIONS, Doing, Span, actions_in, between

WALK = Doing("floor", "walk", carries=True)


def played(*parts: tuple[int, tuple[Doing, ...]]) -> list[tuple[Doing, ...]]:
    return [doings for frames, doings in parts for _ in range(frames)]


def cup(action: str) -> Doing:
    return Doing("cup", action)


SCENARIO = played(
    (5, (Doing("door", "open"),)),
    (2, ()),
    (5, (Doing("door", "close"),)),
    (10, (WALK,)),
    (3, ()),
    (5, (Doing("switch", "press"),)),
    (10, (WALK,)),
    (5, (WALK, cup("reach"))),
    (5, (WALK, cup("grasp"))),
    (5, (WALK, cup("lift"))),
    (10, (WALK, cup("carry"))),
    (5, (Doing("tap", "turn"), cup("carry"))),
    (10, (WALK, cup("carry"))),
    (5, (WALK, cup("drink"))),
    (10, (WALK, cup("carry"))),
    (5, (Doing("chair", "sit"), cup("carry"))),
    (5, ()),
)


def test_the_table_has_21_scores_and_two_that_it_left_out() -> None:
    scores = [action.score for action in ACTIONS] + list(TRANSITIONS)
    known = [score for score in scores if score is not None]
    assert (len(scores), len(known)) == (23, 21)
    assert sum(known) / len(known) == pytest.approx(MEAN, abs=0.05)
    assert sorted(known)[:5] == [2.2, 2.4, 2.4, 2.4, 2.4]  # 5.4.2: five were under 2.5


def test_all_twelve_are_found_in_their_order() -> None:
    spans = actions_in(SCENARIO)
    found = [(span.first, span.end) for span in spans if span is not None]
    assert found == [
        (0, 12), (12, 22), (25, 30), (30, 40), (40, 45), (45, 50), (50, 65), (65, 70), (70, 80), (80, 85), (85, 95),
        (95, 100),
    ]  # fmt: skip


def test_what_was_not_played_is_none_and_so_are_the_walks_to_it() -> None:
    without = [doings for doings in SCENARIO if not any(doing.kind == "tap" for doing in doings)]
    spans = actions_in(without)
    assert [number for number, span in enumerate(spans) if span is None] == [6, 7, 8]
    assert actions_in([(WALK,)] * 9) == [None] * 12


def test_another_order_is_another_scenario() -> None:
    spans = actions_in(SCENARIO[::-1])
    assert sum(span is not None for span in spans) < 12


def test_a_transition_holds_the_pause_and_a_part_of_both() -> None:
    assert between(Span(0, 50), Span(60, 100), 10, 200) == Span(40, 70)
    assert between(Span(45, 50), Span(60, 64), 10, 200) == Span(45, 64)
    assert between(None, Span(60, 64), 10, 200) is None
    assert between(Span(45, 50), None, 10, 200) is None
