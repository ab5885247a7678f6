"""A process's silence, without the time in which the machine kept it waiting; by a clock of the test's own."""

from __future__ import annotations

import os

import pytest

from ahmss.processes.silence import Silence, Thread, share_of_each, threads_of


class Machine:
    """A clock that the test moves on, and what the kernel would say of the threads of process 7."""

    def __init__(self, share: float = 1.0) -> None:
        self.now = 50.0
        self.threads: dict[int, Thread] | None = {7: Thread(2.0, 3.0, False)}
        self.share = share

    def silence(self) -> Silence:
        return Silence(lambda: self.now, self.threads_of, lambda: self.share)

    def threads_of(self, pid: int) -> dict[int, Thread] | None:
        assert pid == 7
        return None if self.threads is None else dict(self.threads)

    def pass_time(self, silence: Silence, seconds: float, waits: dict[int, float] | None = None, pid: int = 7) -> float:
        """In looks of a tenth of a second; `waits`: of each thread, the share without a processor; else it ran."""
        lasts = 0.0
        for _ in range(round(seconds / 0.1)):
            self.now += 0.1
            for thread, part in (waits or {}).items():
                assert self.threads is not None
                ran, waited, _ = self.threads.get(thread, Thread(0.0, 0.0, True))
                self.threads[thread] = Thread(ran + 0.1 * (1.0 - part), waited + 0.1 * part, True)
            lasts = silence.lasts(pid)
        return lasts


def test_one_that_sleeps_is_silent_all_the_while() -> None:
    machine = Machine()
    assert machine.pass_time(machine.silence(), 2.0) == pytest.approx(2.0)


def test_time_without_a_processor_is_not_its_own() -> None:
    machine = Machine()
    silence = machine.silence()
    machine.pass_time(silence, 0.1)  # the first look has nothing to compare with
    assert machine.pass_time(silence, 10.0, {7: 0.9}) == pytest.approx(0.1 + 1.0)


def test_of_its_threads_the_one_that_waited_most_counts_a_new_one_too() -> None:
    machine = Machine()
    silence = machine.silence()
    machine.pass_time(silence, 0.1)
    assert machine.pass_time(silence, 1.0, {7: 0.25, 8: 0.75}) == pytest.approx(0.1 + 0.25)


def test_one_that_computes_all_the_while_is_silent() -> None:
    machine = Machine()
    assert machine.pass_time(machine.silence(), 2.0, {7: 0.0}) == pytest.approx(2.0)


def test_a_wait_that_lasts_counts_before_the_kernel_counts_it_and_once() -> None:
    machine = Machine()
    silence = machine.silence()
    machine.threads = {7: Thread(2.0, 3.0, True)}  # ready, and neither runs nor has run: nothing changes
    assert machine.pass_time(silence, 5.0) == pytest.approx(0.1)
    machine.threads = {7: Thread(2.01, 8.0, False)}  # it had waited from the beginning on
    assert machine.pass_time(silence, 0.1) == pytest.approx(0.1)
    assert machine.pass_time(silence, 1.0) == pytest.approx(1.1)


def test_while_main_itself_is_held_up_little_is_counted() -> None:
    machine = Machine()
    silence = machine.silence()
    machine.now += 60.0
    assert silence.lasts(7) == pytest.approx(0.25)


def test_asked_again_it_begins_anew() -> None:
    machine = Machine()
    silence = machine.silence()
    machine.pass_time(silence, 3.0, {7: 0.5})
    machine.threads = {7: Thread(2.0, 3.0, False)}
    silence.begin()
    assert not silence.due
    assert silence.lasts(7) == 0.0
    assert machine.pass_time(silence, 1.0) == pytest.approx(1.0)
    assert not silence.due
    machine.now += 0.06
    assert silence.due


@pytest.mark.parametrize("pid", [0, 7])
def test_where_nobody_knows_who_waits_a_second_is_shared_among_all(pid: int) -> None:
    machine = Machine(share=0.25)
    machine.threads = None
    assert machine.pass_time(machine.silence(), 4.0, pid=pid) == pytest.approx(1.0)


def test_what_the_system_says() -> None:
    threads = threads_of(os.getpid())
    if os.path.exists("/proc/self/schedstat"):
        assert threads is not None
        assert threads[os.getpid()].ran > 0.0
        assert threads[os.getpid()].ready
    assert threads_of(2**30) is None
    assert 0.0 < share_of_each() <= 1.0
