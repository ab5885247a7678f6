"""The clients that the server has heard of, and when it gives one up for gone."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

__all__ = ["Session", "Sessions"]

_MOST_SESSIONS = 8192
_IDLE_S = 60.0
_COMPLAINT_S = 1.0
_PATIENCE = 20.0


@dataclass(slots=True)
class Session:
    """One client, by the identity of its connection. `was_dropped`: its lease ran out; it may not know yet."""

    identity: bytes
    heard_at: float
    is_main: bool = False
    was_dropped: bool = False
    malformed: int = 0
    complained_at: float = -_COMPLAINT_S


class Sessions:
    """All clients.

    Args:
        lease_s: a main that is silent for so long is gone: what it holds is free.
        patient: in lockstep a main may compute for long; while its connection stands it gets 20 leases.
    """

    def __init__(self, lease_s: float, *, patient: bool) -> None:
        self.lease_s, self._patient = lease_s, patient
        self.malformed = 0
        self._all: dict[bytes, Session] = {}

    def __len__(self) -> int:
        """How many are remembered."""
        return len(self._all)

    def hear(self, identity: bytes, now: float) -> Session:
        """A message has come."""
        session = self._all.get(identity)
        if session is None:
            if len(self._all) >= _MOST_SESSIONS:
                self._forget_idle(now, 0.0)
            session = self._all[identity] = Session(identity, now)
        session.heard_at = now
        return session

    def complain(self, session: Session, now: float) -> bool:
        """Count a malformed message; whether to answer it (at most once a second)."""
        session.malformed += 1
        self.malformed += 1
        if now - session.complained_at < _COMPLAINT_S:
            return False
        session.complained_at = now
        return True

    def lapsed(self, now: float, is_reachable: Callable[[bytes], bool]) -> list[bytes]:
        """Mains that are gone; they are told once. Others that are idle are forgotten."""
        gone: list[bytes] = []
        for session in self._all.values():
            silence = now - session.heard_at
            if not session.is_main or silence <= self.lease_s:
                continue
            if self._patient and silence <= self.lease_s * _PATIENCE and is_reachable(session.identity):
                continue
            session.is_main, session.was_dropped = False, True
            gone.append(session.identity)
        self._forget_idle(now, _IDLE_S)
        return gone

    def _forget_idle(self, now: float, idle_s: float) -> None:
        idle = [s.identity for s in self._all.values() if not s.is_main and now - s.heard_at > idle_s]
        for identity in idle:
            del self._all[identity]
