"""`ahmss capture doctor`: port, permission, baud rate, cable, power, stations, signal; and what to do."""

from __future__ import annotations

import json
import time
from dataclasses import asdict, dataclass

import numpy as np

from ahmss.capture import setup
from ahmss.capture.config import LineConfig, TrackerConfig
from ahmss.capture.device import Tracker
from ahmss.capture.formats import fastrak_ascii, fastrak_binary, liberty
from ahmss.capture.port import open_port
from ahmss.capture.stations import TRACKED, Status, TrackerFrame
from ahmss.capture.trouble import Heard, of_error, of_silence

__all__ = ["BAUDS", "Finding", "bits_a_second", "examine", "examine_tracker"]

BAUDS = (115_200, 57_600, 38_400, 19_200, 9_600, 4_800, 2_400, 921_600)
"""Tried where the configured rate brings nothing: what FASTRAK's and Liberty's switches can set, commonest first."""

_LISTEN = 2.0  # seconds of frames that are looked at
_PATIENCE = 5.0  # seconds until the first of them


@dataclass(frozen=True)
class Finding:
    """One thing looked at; `cure` says what to do where it is not well."""

    what: str
    ok: bool
    found: str
    cure: str = ""


def examine_tracker(config: TrackerConfig, *, as_json: bool = False) -> int:
    """Print what `examine` finds; returns how much of it is not well."""
    findings = examine(config)
    ill = sum(not finding.ok for finding in findings)
    if as_json:
        print(json.dumps({"ok": ill == 0, "findings": [asdict(finding) for finding in findings]}))
        return ill
    for finding in findings:
        print(f"{'ok  ' if finding.ok else 'ILL '} {finding.what}: {finding.found}")
        if finding.cure:
            print(f"     to mend it: {finding.cure}")
    return ill


def examine(config: TrackerConfig) -> list[Finding]:
    """Look at every line by itself, then at the frames of all together; takes some seconds."""
    findings = [finding for line in config.line for finding in _line(config, line)]
    if all(finding.ok for finding in findings):
        findings += _frames(config)
    return findings


def bits_a_second(config: TrackerConfig, line: LineConfig) -> float:
    """What the line must carry: ten bits a byte, eleven with parity."""
    module = liberty if config.kind != "fastrak" else fastrak_binary if config.format == "binary" else fastrak_ascii
    bits = 10 if line.parity == "none" else 11
    return module.length(config.layout(line)) * len(line.stations) * config.rate * bits


def _line(config: TrackerConfig, line: LineConfig) -> list[Finding]:
    """Can it be opened, does the device answer, are its stations there, is the line fast enough?"""
    try:
        answers = _ask(config, line, line.baud)
        if answers.status is None:
            return [_other_baud(config, line, answers)]
    except OSError as error:
        where, _, cure = of_error(line.port, error).partition("; ")
        return [Finding("port", False, where, cure)]
    text = f"{line.port} at {line.baud} baud: {answers.status.text or config.kind} {answers.status.firmware}".rstrip()
    findings = [Finding("line", True, text)]
    if answers.status.error:
        found = f"{line.port}: its own tests report error {answers.status.error}"
        findings.append(Finding("device", False, found, "switch it off and on; look up the number in its manual"))
    return [*findings, _stations(config, line, answers), _speed(config, line)]


def _ask(config: TrackerConfig, line: LineConfig, baud: int, patience: float = 1.0) -> setup.Answers:
    """What the device says at this rate.

    Raises:
        OSError: the port can't be opened, or went away.
    """
    with open_port(line, baud) as port:
        return setup.ask(port, config, line, patience)


def _other_baud(config: TrackerConfig, line: LineConfig, answers: setup.Answers) -> Finding:
    """Nothing was understood at the configured rate: try the others.

    Raises:
        OSError: the port went away.
    """
    heard = answers.heard
    for baud in BAUDS:
        if baud == line.baud:
            continue
        other = _ask(config, line, baud, 0.3)
        heard += other.heard
        if other.status is not None:
            found = f"{line.port}: {config.kind.upper()} answers at {baud} baud, the file says {line.baud}"
            return Finding("baud rate", False, found, f"write baud = {baud} in its [[line]]")
    silence = of_silence(config, line, Heard(time.monotonic(), heard), time.monotonic())
    if heard:
        found = f"{line.port}: bytes come, but no answer of a {config.kind.upper()} at any baud rate"
        return Finding(
            "device", False, found, f"is kind = {config.kind!r} right? is the cable shielded and not too long?"
        )
    where, _, cure = silence.partition("; ")
    return Finding("cable or power", False, where, cure)


def _stations(config: TrackerConfig, line: LineConfig, answers: setup.Answers) -> Finding:
    """Are the sensors there that the file counts on?"""
    if answers.stations is None:
        return Finding("stations", True, f"{line.port}: it does not say which; {len(line.stations)} are expected")
    wanted = {local: name for local, name in enumerate(line.stations, 1) if name in config.rows}
    missing = [local for local in wanted if local not in answers.stations]
    if not missing:
        return Finding("stations", True, f"{line.port}: {len(answers.stations)} sensors")
    names = ", ".join(f"{local} ({TRACKED[config.rows[wanted[local]]]})" for local in missing)
    cure = "plug them in and switch the device off and on, or take them out of the file"
    return Finding("stations", False, f"{line.port}: no sensor at its station {names}", cure)


def _speed(config: TrackerConfig, line: LineConfig) -> Finding:
    """Can the line carry what the device is told to send?"""
    need = bits_a_second(config, line)
    found = f"{line.port}: {need / 1000:.0f} of {line.baud / 1000:.0f} kbaud"
    if need <= line.baud:
        return Finding("speed", True, found)
    best = config.rate * line.baud / need
    cure = f"at most {best:.0f} frames a second get through: raise the baud rate, use binary, or spread the stations"
    return Finding("speed", False, found, cure)


def _frames(config: TrackerConfig) -> list[Finding]:
    """Two seconds of frames: how many, and how well every link is seen."""
    with Tracker(config) as tracker:
        frames = _capture(tracker)
        silence, losses = tracker.silence, tracker.losses
    if len(frames) < 2:
        where, _, cure = (silence or "the tracker: nothing came; look at its power and its cable").partition("; ")
        return [Finding("frames", False, where, cure)]
    rate = (len(frames) - 1) / max(1e-3, frames[-1].arrival - frames[0].arrival)
    slow, fast = rate < 0.9 * config.rate, rate > 1.1 * config.rate
    cure = f"write rate = {rate:.0f}" + (", or see what the line can carry" if slow else "") if slow or fast else ""
    return [
        Finding("frames", not cure, f"{rate:.1f} a second, the file says {config.rate:g}; {losses.sentence}", cure),
        *_signal(config, frames),
    ]


def _capture(tracker: Tracker) -> list[TrackerFrame]:
    """The frames of two seconds, from the first one on; none where none comes."""
    frames: list[TrackerFrame] = []
    end = time.monotonic() + _PATIENCE
    while time.monotonic() < end:
        came = tracker.poll()
        if came and not frames:
            end = time.monotonic() + _LISTEN
        frames += came
        time.sleep(0.01)
    return frames


def _signal(config: TrackerConfig, frames: list[TrackerFrame]) -> list[Finding]:
    """Links that are weak, missing or implausible in more than a twentieth of the frames."""
    status = np.stack([frame.status for frame in frames])
    words = {
        Status.WEAK: ("weak", "come nearer to the transmitter, and away from steel"),
        Status.MISSING: ("missing", "look at the sensor's plug and its cable"),
        Status.IMPLAUSIBLE: ("jumping", "look at the sensor's plug, for steel nearby, and at `hemisphere`"),
    }
    findings: list[Finding] = []
    for kind, (word, cure) in words.items():
        share = np.mean(status == kind, axis=0)
        links = [link for link in config.stations if share[TRACKED.index(link)] > 0.05]
        if links:
            findings.append(Finding("signal", False, f"{word}: {', '.join(links)}", cure))
    return findings or [Finding("signal", True, f"good on all {len(config.stations)} links")]
