"""Ten operators at five panels, each with a main of its own that is moved through its port, for as long as is asked."""

from __future__ import annotations

import json
import os
import random
import re
import subprocess
import sys
import threading
import time
from dataclasses import dataclass, field
from pathlib import Path

from ahmss.client import Client
from ahmss.database.layout import init
from ahmss.database.workspace import Workspace
from ahmss.errors import ActionFailed, NoAnswer, PortRefused
from ahmss.world.client import WorldClient
from ahmss.world.process import ServerProcess
from ahmss.world.schema import StateValue

PANELS, APART = 5, 1.5  # metres between two panels
_POSITIONS = ("off", "low", "high")


def room(root: Path, source: Path) -> Path:
    """A workspace with a room of five panels in a row, each with a gauge that shows the lever which two share."""
    workspace = init(root, Workspace(source))
    lines = ['name = "crew_room"', 'sentence = "Five panels in a row."', "contains = [", '  { kind = "floor" },']
    for k in range(PANELS):
        y = APART * (k - (PANELS - 1) / 2)
        lines.append(f'  {{ kind = "panel", name = "panel_{k}", position = [1.5, {y}, 0], facing_deg = 180 }},')
        lines.append(f'  {{ kind = "gauge", name = "gauge_{k}", position = [1.95, {y}, 1.5], facing_deg = 180 }},')
    lines.append("]")
    for k in range(PANELS):
        lines += ["[[consequences]]", f'at = "panel_{k}/lever_5"', 'from = "level"', f'of = "gauge_{k}"']
        lines += ['state = "value"']
    home = workspace.root / "objectdb" / "crew_room"
    home.mkdir()
    (home / "object.toml").write_text("\n".join(lines) + "\n")
    return workspace.root


def memory_mb(pid: int) -> float:
    """What a process has in memory of its own: neither files nor what it shares."""
    text = Path(f"/proc/{pid}/status").read_text()
    return next(int(line.split()[1]) for line in text.splitlines() if line.startswith("RssAnon")) / 1024


def cpu_s(pid: int) -> float:
    """Seconds of processor time of a process."""
    words = Path(f"/proc/{pid}/stat").read_text().rsplit(")", 1)[1].split()
    return (int(words[11]) + int(words[12])) / os.sysconf("SC_CLK_TCK")


@dataclass
class Operator:
    """One human: its main, what it did last with what, and what went wrong."""

    name: str
    panel: int
    side: int  # 0: at the left half of the panel, 1: at the right one
    process: subprocess.Popen[str]
    port: str
    done: int = 0
    yielded: int = 0  # what somebody else had
    wrong: list[str] = field(default_factory=list[str])
    left: dict[str, dict[str, StateValue]] = field(default_factory=dict[str, dict[str, StateValue]])
    off: list[float] = field(default_factory=list[float])  # between the level wanted and the one that it came to
    frames: list[tuple[float, int, int, int]] = field(default_factory=list[tuple[float, int, int, int]])
    memory: list[float] = field(default_factory=list[float])

    @property
    def lever(self) -> str:
        return f"panel_{self.panel}/lever_{(2, 9)[self.side]}"

    @property
    def button(self) -> str:
        return f"panel_{self.panel}/button_{(12, 19)[self.side]}"

    @property
    def switch(self) -> str:
        return f"panel_{self.panel}/switch_{(3, 8)[self.side]}"

    @property
    def shared(self) -> str:
        return f"panel_{self.panel}/lever_5"

    def work(self, until: float) -> None:
        """Its part of the procedure, again and again."""
        choose = random.Random(self.name)
        try:
            with Client(self.port, timeout=30.0) as client:
                while time.monotonic() < until:
                    self.look(client)
                    level = round(choose.uniform(0.1, 0.9), 2)
                    if self.alone(client, self.lever, "slide", {"level": level}):
                        self.off.append(abs(float(self.left[self.lever]["level"]) - level))
                    before = client.state(self.button)["position"]
                    if self.alone(client, self.button, "press", {}) and self.left[self.button]["position"] == before:
                        self.wrong.append(f"{self.name} {self.button} press: it is {before} as before")
                    self.act(client, self.shared, "slide", {"level": round(choose.uniform(0.1, 0.9), 2)})
                    position = choose.choice(_POSITIONS)
                    if self.alone(client, self.switch, "turn", {"position": position}):
                        found = self.left[self.switch]["position"]
                        if found != position:
                            self.wrong.append(f"{self.name} {self.switch} turn: it is {found}, not {position}")
                    self.act(client, f"gauge_{self.panel}", "check", {})
                self.look(client)
        except NoAnswer as error:
            if self.process.poll() is None:
                self.wrong.append(f"{self.name}: {error}")

    def look(self, client: Client) -> None:
        me = client.me()
        self.frames.append((time.monotonic(), me.frame, me.late, me.held))
        self.memory.append(memory_mb(self.process.pid))

    def alone(self, client: Client, thing: str, action: str, parameters: dict[str, str | float]) -> bool:
        """Do it with what nobody else touches, and remember how it was left."""
        done = self.act(client, thing, action, parameters)
        self.left[thing] = client.state(thing)
        return done

    def act(self, client: Client, thing: str, action: str, parameters: dict[str, str | float]) -> bool:
        """Do it; what another has, or stands before, is left for now."""
        try:
            client.do(thing, action, parameters=parameters).wait(120.0)
        except (PortRefused, ActionFailed) as error:
            if re.search(r"holds it; wait|is held by|waited|stands in the way|when they have gone", str(error)):
                self.yielded += 1
            else:
                self.wrong.append(f"{self.name} {thing} {action}: {error}")
            return False
        self.done += 1
        return True


class Crew:
    """A server, ten mains, and a viewer; a context manager."""

    def __init__(self, folder: Path, source: Path, count: int = 2 * PANELS) -> None:
        self.root = room(folder / "workspace", source)
        self.folder = folder
        self.server = ServerProcess(log=folder / "server.log")
        self.operators: list[Operator] = []
        for number in range(count):
            self.operators.append(self._enter(number))
        self.viewer = WorldClient(self.server.address)

    def __enter__(self) -> Crew:
        return self

    def __exit__(self, *_: object) -> None:
        self.viewer.close()
        for one in self.operators:
            one.process.terminate()
        for one in self.operators:
            try:
                one.process.wait(15.0)
            except subprocess.TimeoutExpired:
                one.process.kill()
                one.process.wait()
            if one.process.stdout is not None:
                one.process.stdout.close()
        self.server.stop()

    def _enter(self, number: int) -> Operator:
        panel, side = divmod(number, 2)
        y = APART * (panel - (PANELS - 1) / 2) + (0.3, -0.3)[side]
        command = [sys.executable, "-m", "ahmss", "main", "--server", self.server.address, "--human", f"op_{number}"]
        command += ["--body", ("ken", "aiko")[(number // 2 + number) % 2], "--at", "1.05", str(y), "--facing", "0"]
        command += ["--port", "127.0.0.1:0", "--no-console", "--json", "--workspace", str(self.root)]
        command += ["--scene", "crew_room"] if number == 0 else []
        with (self.folder / f"op_{number}.log").open("w") as log:
            process = subprocess.Popen(
                command, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=log, text=True
            )  # fmt: skip
        assert process.stdout is not None
        line = process.stdout.readline()
        assert line, (self.folder / f"op_{number}.log").read_text()
        return Operator(f"op_{number}", panel, side, process, json.loads(line)["port"])

    def held(self) -> dict[str, str]:
        """What anybody holds, and who."""
        return {name: one.holder for name, one in self.viewer.refresh().objects.items() if one.holder}

    def work(self, seconds: float, victim: Operator | None = None, after: float = 0.0) -> None:
        """All at once; the victim is killed `after` so many seconds, in the midst of something."""
        until = time.monotonic() + seconds
        threads = [threading.Thread(target=one.work, args=(until,), name=one.name) for one in self.operators]
        for thread in threads:
            thread.start()
        if victim is not None:
            time.sleep(after)
            while victim.name not in self.held().values() and time.monotonic() < until:
                time.sleep(0.02)
            victim.process.kill()
        for thread in threads:
            thread.join()
