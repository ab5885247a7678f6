"""Work that takes its time, beside the frames."""

from __future__ import annotations

import threading
from collections.abc import Callable
from concurrent.futures import Future
from typing import TypeVar

__all__ = ["aside", "at_once"]

T = TypeVar("T")


def aside(work: Callable[[], T]) -> Future[T]:
    """Do it in a thread of its own, so that the body stays alive."""
    future: Future[T] = Future()
    threading.Thread(target=_settle, args=(future, work), name="aside", daemon=True).start()
    return future


def at_once(work: Callable[[], T]) -> Future[T]:
    """Do it here and now: in lockstep nothing depends on how long a thread takes."""
    future: Future[T] = Future()
    _settle(future, work)
    return future


def _settle(future: Future[T], work: Callable[[], T]) -> None:
    try:
        future.set_result(work())
    except Exception as error:  # noqa: BLE001 - raised again where the result is asked for
        future.set_exception(error)
