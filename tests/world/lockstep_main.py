"""A main for the lockstep tests: moves its human, takes and gives one cup, and says what it saw of the others."""

from __future__ import annotations

import random
import sys
import time

import numpy as np
from ground import ROOT, ROTATIONS, join, row

from ahmss.errors import WorldError
from ahmss.world import schema
from ahmss.world.client import WorldClient


def run(address: str, name: str, frames: int, seed: int) -> None:
    """The cup is wanted by every human in the same frame; who is first by name has it for ten frames, then rests."""
    dither = random.Random(time.time_ns())  # how fast this main is must not matter
    steps = np.random.default_rng([seed, *name.encode()]).normal(0, 0.01, (frames, 3))
    with WorldClient(address, follow=False, timeout=30) as client:
        join(client, name)
        client.refresh()
        cup = client.world.objects["cup"].id
        held, rested = 0, 1
        for k in range(1, frames + 1):
            if dither.random() < 0.1:
                time.sleep(dither.random() * 0.004)
            if not held and k >= rested:
                try:
                    client.claim(name, ["cup"], "right")
                    held = k
                except WorldError:
                    held = 0
            elif held and k == held + 10:
                client.begin(schema.SetState([schema.StateChange("cup", "by", f"{name} {k}")]))
                client.release(name, ["cup"])
                held, rested = 0, k + 5
            moved = row(cup, tuple(steps[k - 1])) if held else None
            client.publish(name, k, ROOT + steps[k - 1], ROTATIONS, moved)
            client.collect(behind=1)
        client.collect()
        client.leave(name)


if __name__ == "__main__":
    run(sys.argv[1], sys.argv[2], int(sys.argv[3]), int(sys.argv[4]))
