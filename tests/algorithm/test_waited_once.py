"""An answer that does not come in time is waited for once, where the clock goes on; and thinking yields to frames."""

from __future__ import annotations

from collections.abc import Callable

import pytest
from algorithm_rig import frame, peer

from ahmss.algorithm.messages import Start
from ahmss.processes import launcher as launching
from ahmss.processes.deadlines import Deadlines
from ahmss.processes.launcher import Launcher
from ahmss.processes.process import AlgorithmProcess


@pytest.mark.parametrize("once", [True, False])
def test_who_thinks_for_many_frames_keeps_main_in_one_of_them(
    make_start: Callable[..., Start], monkeypatch: pytest.MonkeyPatch, *, once: bool
) -> None:
    looked: list[AlgorithmProcess] = []
    look = launching._look

    def counted(owing: list[AlgorithmProcess], seconds: float) -> None:
        looked.extend(owing)
        look(owing, seconds)

    with Launcher(warm=False, deadlines=Deadlines(start=10.0, frame=60.0, stop=0.2), once=once) as launcher:
        thinks, good = launcher.start(peer("hangs"), make_start()), launcher.start(peer("good"), make_start())
        for k in (1, 2):
            thinks.ask(frame(k))
            good.ask(frame(k))
            assert launcher.wait([thinks, good], 30.0)
            assert len(thinks.receive()) == len(good.receive()) == 1
        thinks.ask(frame(3))
        assert not launcher.wait([thinks], 0.05)
        monkeypatch.setattr(launching, "_look", counted)
        good.ask(frame(3))
        assert not launcher.wait([thinks, good], 30.0 if once else 0.5)
        assert (thinks in looked) is not once
        assert thinks.pending == 3
        if once:  # the other was waited for
            assert good.pending == 0
