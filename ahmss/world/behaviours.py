"""How the kinds of the objects behave, read from their assets once for all objects of a kind."""

from __future__ import annotations

from collections.abc import Iterable

from ahmss.errors import ProtocolError, WorldError
from ahmss.states.behaviour import Behaviour, decode_behaviour
from ahmss.world.assets import Assets

__all__ = ["Behaviours"]

_NONE = Behaviour()


class Behaviours:
    """Behaviours by the hash of their asset."""

    def __init__(self, assets: Assets) -> None:
        self._assets = assets
        self._known: dict[str, Behaviour] = {"": _NONE}

    def get(self, name: str) -> Behaviour:
        """The behaviour of that hash; none for an asset that was lost, as after a restart with an emptied directory."""
        known = self._known.get(name)
        if known is None:
            data = self._assets.get(name)
            try:
                known = _NONE if data is None else decode_behaviour(data)
            except ProtocolError:  # `check` let none in: the file was damaged since
                known = _NONE
            self._known[name] = known
        return known

    def check(self, names: Iterable[str]) -> None:
        """Refuse an asset that is no behaviour. WorldError: says why."""
        for name in names:
            if name in self._known:
                continue
            try:
                self._known[name] = decode_behaviour(self._assets.get(name) or b"")
            except ProtocolError as error:
                raise WorldError(f"asset {name[:12]}: {error}") from None
