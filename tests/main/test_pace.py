from ahmss.main.pace import Pace


def test_frames_keep_to_the_clock_and_do_not_drift() -> None:
    now = [100.0]
    pace = Pace(50.0, clock=lambda: now[0])
    for frame in range(100):
        assert abs(pace.left() - (100.0 + frame * 0.02 - now[0])) < 1e-9
        now[0] += max(pace.left(), 0.0) + 0.003  # always woken 3 ms late
        pace.advance()
    assert abs(pace.due - 102.0) < 1e-9
    assert pace.late == 0


def test_after_a_long_stall_it_does_not_hurry() -> None:
    now = [0.0]
    pace = Pace(50.0, clock=lambda: now[0])
    pace.advance()
    now[0] = 5.0
    pace.advance()
    assert pace.late == 1
    assert abs(pace.left() - 0.02) < 1e-9


def test_fast_never_waits() -> None:
    pace = Pace(60.0, fast=True)
    pace.advance()
    assert pace.left() == 0.0
