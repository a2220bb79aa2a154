"""Killing the program at random moments of the tour: what is finished is whole, and the next start offers it.

Run by `make window-kills`; `--kills N` for another number than 20. A program that ends before it is killed is
a problem, too, unless its tour was over.
"""

from __future__ import annotations

import os
import random
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import psutil

from app.library.places import SESSIONS_VARIABLE
from core.session import Session
from core.session.record import folder_digest
from core.stages import STAGE_NAMES

KILLS = 20
LONGEST_S = 50.0
"""The tour takes about a minute; a kill after it would show nothing."""
GONE_WITHIN_S = 30.0
"""Workers that are still being started end when they have been: seconds, or more on a busy machine."""
TOUR = """
from app.gui.headless_check import Tour, Walk
from app.gui.main import make_application, open_window

window = open_window(make_application())
Tour(Walk(window), lambda line: print(line, flush=True)).run()
print("toured", flush=True)
window.close_without_asking()
"""
LOOK = """
from app.gui.headless_check import Walk
from app.gui.main import make_application, open_window

window = open_window(make_application())
print(window.messages.sentence)
walk = Walk(window)
if window.messages.sentence:
    walk.click("message_action")
    walk.wait(lambda: window.desk.workspace.session, "the session is open", 10)
    stages = window.desk.workspace.stages
    print(" ".join(f"{name}={state.value}" for name, state in stages.items()))
window.close_without_asking()
"""


@dataclass(frozen=True)
class Killed:
    """One try.

    Attributes:
        problems: what was wrong; empty if nothing.
        found: how the session stood for the next start.
        in_time: whether it was killed before its tour was over.
    """

    problems: str
    found: str
    in_time: bool


def main() -> None:
    """Kill, look, tell; exit code 1 if anything was lost or left behind, or nothing was killed."""
    tries = int(sys.argv[sys.argv.index("--kills") + 1]) if "--kills" in sys.argv else KILLS
    pick = random.Random(0)
    n_failures = n_killed = 0
    for number in range(1, tries + 1):
        after_s = pick.uniform(1.0, LONGEST_S)
        with tempfile.TemporaryDirectory() as home:
            tried = kill_once(Path(home), after_s)
        n_failures += bool(tried.problems)
        n_killed += tried.in_time
        when = f"killed after {after_s:4.1f} s" if tried.in_time else "the tour was over"
        print(f"{number:2}: {when}; {tried.found}{' PROBLEM: ' if tried.problems else ''}{tried.problems}")
    print(f"{n_killed} kills, {n_failures} with a problem")
    sys.exit(bool(n_failures) or not n_killed)


def kill_once(home: Path, after_s: float, script: str = TOUR) -> Killed:
    """Start the program in an empty `home`, kill it after a time, and start it again."""
    temporary, said = home / "temporary", home / "said.txt"
    temporary.mkdir()
    environment = os.environ | {
        "TMPDIR": str(temporary),
        "QT_QPA_PLATFORM": "offscreen",
        "XDG_CONFIG_HOME": str(home / "config"),
        SESSIONS_VARIABLE: str(home / "sessions"),
    }
    environment.pop("DISPLAY", None)
    with said.open("w") as file:
        program = subprocess.Popen([sys.executable, "-c", script], env=environment, stdout=file, stderr=file)
    deadline_s = time.monotonic() + after_s
    while program.poll() is None and time.monotonic() < deadline_s:
        time.sleep(0.02)
    program.send_signal(signal.SIGKILL)
    in_time = program.wait() == -signal.SIGKILL
    lines = said.read_text().splitlines() or [""]
    problems = [] if in_time or "toured" in lines else [f"it ended by itself: {lines[-1]}"]
    problems += stayed(temporary)
    sessions = sorted((home / "sessions").glob("[!.]*")) if (home / "sessions").is_dir() else []
    for path in sessions:
        problems += _damages(path)
    looked = _look(environment)
    offered, found = [*looked.stdout.splitlines(), "", ""][:2]
    if looked.returncode != 0:
        problems.append(f"the next start failed: {looked.stderr.splitlines()[-1:]}")
    elif sessions and in_time and not any(f"'{path.name}'" in offered for path in sessions):
        problems.append(f"the next start did not offer the session: {offered}")
    left = sorted(path.name for path in temporary.iterdir())
    if left:
        problems.append(f"left in the temporary folder: {', '.join(left)}")
    return Killed("; ".join(problems), found or "before a session", in_time)


def stayed(temporary: Path) -> list[str]:
    """Wait for the processes with this temporary folder to end; name those that do not, and end them."""
    deadline_s = time.monotonic() + GONE_WITHIN_S
    while (alive := list(_those_of(temporary))) and time.monotonic() < deadline_s:
        time.sleep(0.1)
    for process in alive:
        process.kill()
    psutil.wait_procs(alive)
    return [f"{len(alive)} processes stayed"] if alive else []


def _those_of(temporary: Path) -> Iterator[psutil.Process]:
    for process in psutil.process_iter(["environ", "status"]):
        environment = process.info["environ"] or {}
        if environment.get("TMPDIR") == str(temporary) and process.info["status"] != psutil.STATUS_ZOMBIE:
            yield process


def _damages(path: Path) -> list[str]:
    """Every stage that has a record must be exactly what was recorded."""
    with Session.open(path) as session:
        return [
            f"{stage} is damaged"
            for stage in STAGE_NAMES
            if (record := session.record(stage)) is not None and folder_digest(path / stage) != record.digest
        ]


def _look(environment: dict[str, str]) -> subprocess.CompletedProcess[str]:
    """Start the program again; it prints what it offers, then how the session stands."""
    return subprocess.run(
        [sys.executable, "-c", LOOK],
        env=environment,
        capture_output=True,
        text=True,
        timeout=120,
        check=False,
    )


if __name__ == "__main__":
    main()
