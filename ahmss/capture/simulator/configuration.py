"""A configuration for the driver that fits a simulated tracker, as a user would write it for a real one."""

from __future__ import annotations

import os
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from ahmss.capture.simulator.options import SimulatorOptions
from ahmss.capture.simulator.sensors import Mounts, measure
from ahmss.capture.stations import TRACKED

__all__ = ["configuration", "write_configuration"]

_HALVES = ((0.0, 0.0, 1.0), (0.0, 0.0, -1.0), (1.0, 0.0, 0.0), (-1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, -1.0, 0.0))


def write_configuration(path: Path, options: SimulatorOptions, addresses: Sequence[str]) -> None:
    """Write the file; it takes its name when it is whole, so that whoever waits for it can read it."""
    path.parent.mkdir(parents=True, exist_ok=True)
    unfinished = path.with_name(f".{path.name}.{os.getpid()}")
    unfinished.write_text(configuration(options, addresses), encoding="utf-8")
    unfinished.replace(path)


def configuration(options: SimulatorOptions, addresses: Sequence[str]) -> str:
    """The text, for lines (or one UDP port) at these addresses."""
    transmitter = options.transmitter
    parts = [
        "# Written by `ahmss capture simulate`: fits the tracker that it is.\n",
        f'kind = "{options.kind}"\nformat = "binary"\norientation = "quaternion"\nunits = "cm"\n',
        f"rate = {options.frames_a_second:g}\nhemisphere = {_half(options)}  # all sensors stay in it\n",
    ]
    if options.kind == "ultratrak":
        host, _, port = addresses[0].rpartition(":")
        parts.append(f'[udp]\nport = {port}\naddress = "{host}"\n')
    else:
        for address, stations in zip(addresses, options.units(), strict=True):
            parts.append(f'[[line]]\nport = "{address}"\nbaud = {options.baud}\nstations = {list(stations)}\n')
    links = "\n".join(f"{link} = {number}" for number, link in enumerate(TRACKED[: options.stations], 1))
    parts.append(f"[stations]\n{links}\n")
    parts.append(
        f"[transmitter]\nposition = {list(transmitter.position)}\nfacing_deg = {transmitter.facing_deg:g}\n"
        f"upside_down = {str(transmitter.upside_down).lower()}\n"
    )
    return "\n".join(parts)


def _half(options: SimulatorOptions) -> str:
    """The half of space in which the sensors are all along: on the floor's side of the transmitter or on the other.

    Where they are on both, at a transmitter at half the subject's height, the side of it on which they stay clearest.
    """
    straight, performance = Mounts.straight(), options.performance
    places = measure(performance, straight, options.transmitter)[1].reshape(-1, 3)
    least = (places @ np.array(_HALVES).T).min(axis=0)
    best = int(least[:2].argmax()) if least[:2].max() > 0.0 else int(least.argmax())
    return str([round(part) for part in _HALVES[best]])
