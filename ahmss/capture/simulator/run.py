"""The simulator as a process: it opens the lines, says where they are, and serves them until it is told to end."""

from __future__ import annotations

from ahmss.capture.simulator.options import SimulatorOptions

__all__ = ["run_simulator"]


def run_simulator(options: SimulatorOptions) -> None:
    """Be a tracker until SIGINT or SIGTERM, or until `quit` is typed.

    Prints one line for each unit, `line 1: /dev/pts/4 (stations 1 to 4, 115200 baud)`, then reads commands from the
    standard input: `help` lists them.

    Raises:
        CommandError: the options do not fit together.
    """
    raise NotImplementedError
