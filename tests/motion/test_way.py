"""A way is as wide on every wire, and one that is not known is never taken for one."""

from __future__ import annotations

import numpy as np
import pytest

from ahmss.motion.way import AHEAD, UNKNOWN, WAY_WIDTH, known
from ahmss.world import schema


def test_a_way_is_as_wide_wherever_it_goes() -> None:
    assert WAY_WIDTH == schema.WAY_WIDTH == np.prod(schema.WAY_SHAPE) == 12
    assert UNKNOWN.shape == schema.WAY_SHAPE
    np.testing.assert_allclose(AHEAD, [0.4, 0.8, 1.2, 1.6, 2.0, 2.4])


def test_what_all_share_is_not_written_to() -> None:
    for shared in (AHEAD, UNKNOWN):
        with pytest.raises(ValueError, match="read-only"):
            shared[0] = 1.0


def test_numbers_are_a_way_or_none() -> None:
    assert known(UNKNOWN.ravel()) is None
    way = known(np.arange(12.0))
    assert way is not None
    np.testing.assert_array_equal(way[1], [2.0, 3.0])
