"""Killing the program at random moments: of all stages, a scan, a pour, an evaluation, and the window.

Nothing that was finished may be lost or damaged, no process may stay, the same command must go on to its end,
and after it the temporary folder must be empty. Run by `make kills`; `--kills N` for another number than 200,
`--minutes M` for an end before that.
"""

from __future__ import annotations

import argparse
import os
import random
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from itertools import cycle
from pathlib import Path

from core.mesh_file import write_mesh
from core.session import StageRecord
from core.session.record import folder_digest
from core.stages import STAGE_NAMES
from hardware.simulation.objects import builtin_object
from tests.app.operations.evaluation.fakes import write_labels
from tests.app.sessions import QUICK, make_session
from tests.benchmarks import window_kills

KILLS = 200
OBJECT = "bowl"
LONGEST_S = 300.0
_EVALUATED = ("--input=mesh", "--variant=imagination", "--pours=1")
_FEWER = (
    "--set=pouring.theta_fixed_rad=0",
    "--set=containability.verdict=omega",
    *(f"--set={k}={v}" for k, v in QUICK.items()),
)


@dataclass(frozen=True)
class Job:
    """A command to kill.

    Attributes:
        name: what is under way when it is killed.
        words: of the command, which works in `place`.
        prepare: puts into an empty folder what the command needs.
        finished: what is finished there: a name and a digest of each.
    """

    name: str
    words: Callable[[Path], list[str]]
    prepare: Callable[[Path], object]
    finished: Callable[[Path], dict[str, str]]


@dataclass
class Series:
    """The kills of one job; each goes on with what the one before it left.

    Attributes:
        job: that is killed.
        root: of its folders.
        seconds: the command takes when it is not killed, or what was left of it took.
        moments: what was the last to be finished when it was killed, and how often.
        n_kills: so far.
        problems: that were found.
    """

    job: Job
    root: Path
    seconds: float = 0.0
    n_kills: int = 0
    moments: Counter[str] = field(default_factory=Counter)
    problems: list[str] = field(default_factory=list)

    @property
    def place(self) -> Path:
        """Where the command works."""
        return self.root / "place"

    @property
    def temporary(self) -> Path:
        """Its temporary folder."""
        return self.root / "temporary"

    def begin(self) -> None:
        """Measure how long the command takes, and prepare for the first kill."""
        self._prepare()
        started = time.monotonic()
        self._run_to_its_end()
        self.seconds = time.monotonic() - started
        self._prepare()

    def kill(self, pick: random.Random) -> None:
        """Kill once; what is finished by then is whole, and what was finished before still there."""
        before = self.job.finished(self.place)
        with self._start() as process:
            began_s = time.monotonic()
            said = _until(process, pick.uniform(0.1, 1.0) * self.seconds)
            elapsed_s = time.monotonic() - began_s
            process.kill()
        self.problems += window_kills.stayed(self.temporary)
        after = self.job.finished(self.place)
        self.problems += [f"{name} was lost or changed" for name in before if after.get(name) != before[name]]
        self.problems += [f"{name} is damaged" for name, digest in after.items() if digest == "damaged"]
        if process.returncode == -signal.SIGKILL:
            self.n_kills += 1
            self.moments[list(after)[-1] if after else "nothing"] += 1
        else:  # it came to its end: another one from the beginning
            self._check_end(process.returncode, said)
            self.seconds = min(self.seconds, elapsed_s)  # what is left of it, or the machine is quicker now
            self._prepare()

    def end(self) -> None:
        """Let the command go on to its end; nothing is left in the temporary folder."""
        before = self.job.finished(self.place)
        self._run_to_its_end()
        after = self.job.finished(self.place)
        self.problems += [f"{name} was done again" for name in before if after.get(name) != before[name]]

    def _prepare(self) -> None:
        for folder in (self.place, self.temporary):
            shutil.rmtree(folder, ignore_errors=True)
        self.temporary.mkdir(parents=True)
        self.job.prepare(self.place)

    def _start(self) -> subprocess.Popen[str]:
        environment = os.environ | {
            "TMPDIR": str(self.temporary),
            "XDG_CACHE_HOME": str(self.root / "cache"),
            "PYTHONPATH": os.pathsep.join(sys.path),
        }
        words = [sys.executable, "-m", "app.cli", *self.job.words(self.place)]
        return subprocess.Popen(
            words, env=environment, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True
        )

    def _run_to_its_end(self) -> None:
        with self._start() as process:
            said = _until(process, LONGEST_S)
            process.kill()
        self._check_end(process.returncode, said)

    def _check_end(self, code: int, said: str) -> None:
        """One that ended by itself has done its work, and leaves nothing in the temporary folder."""
        if code != 0:
            self.problems.append(f"exit code {code}: {said.strip().splitlines()[-1:]}")
        left = sorted(path.name for path in self.temporary.iterdir() if not _is_probe(path))
        if left:
            self.problems.append(f"left in the temporary folder: {', '.join(left)}")


def jobs(base: Path) -> list[Job]:
    """Return everything that is killed but the window; `base` is a session that was imagined."""
    made = [name for name in STAGE_NAMES if name not in ("scan", "mesh")]
    return [
        Job("stages", lambda p: ["report", str(p)], lambda p: _without(base, p, *made), _stages_of),
        Job("scan", lambda p: ["scan", f"--session={p}", f"--object={OBJECT}"], _nothing, _stages_of),
        Job("pour", lambda p: ["pour", str(p), "--yes", "--anyway"], lambda p: _without(base, p), _stages_of),
        Job(
            "evaluate",
            lambda p: ["evaluate", str(p / "objects"), f"--out={p / 'out'}", *_EVALUATED, *_FEWER],
            _objects,
            _trials_of,
        ),
    ]


def _is_probe(path: Path) -> bool:
    """Whether Python's `tempfile` made it to try out the folder; killed meanwhile, it leaves four bytes."""
    return path.is_file() and path.read_bytes() == b"blat"


def _nothing(place: Path) -> None:
    """The command makes the folder itself."""


def _without(base: Path, place: Path, *parts: str) -> None:
    shutil.copytree(base, place, symlinks=True)
    for part in parts:
        shutil.rmtree(place / part, ignore_errors=True)


def _objects(place: Path) -> None:
    folder = place / "objects"
    folder.mkdir(parents=True)
    for name in ("bowl", "block", "ring"):
        write_mesh(folder / f"{name}.obj", builtin_object(name))
    write_labels(folder, bowl="container", block="non-container", ring="non-container")


def _stages_of(place: Path) -> dict[str, str]:
    """The finished stages with their digests; one that is not what its record says has none."""
    if not place.is_dir():
        return {}
    found = {}
    for name in STAGE_NAMES:
        record = StageRecord.load(place / name)
        if record is not None:
            found[name] = record.digest if folder_digest(place / name) == record.digest else "damaged"
    views: dict[str, str] = {}
    for folder in ("scan-in-progress", "scan"):  # views that are taken move with the scan when it ends
        views |= {taken.name: "taken" for taken in sorted((place / folder).rglob("*.pose.txt"))}
    return views | found


def _trials_of(place: Path) -> dict[str, str]:
    return {path.name: path.read_text() for path in (place / "out").glob("trials/*.json")}


def _until(process: subprocess.Popen[str], seconds: float) -> str:
    """Wait for a time, or the end of the command; return what it said to people by its end."""
    try:
        return process.communicate(timeout=seconds)[1]
    except subprocess.TimeoutExpired:
        return ""


def _kill_window(pick: random.Random) -> window_kills.Killed:
    """Kill the window once during its tour; see `window_kills`."""
    with tempfile.TemporaryDirectory() as home:
        return window_kills.kill_once(Path(home), pick.uniform(1.0, window_kills.LONGEST_S))


def _turns(series: list[Series], kills: int, until_s: float) -> Iterator[Series | None]:
    """Each job in its turn, and none: the window's, until there are enough kills or the time is over."""
    for number, one in enumerate(cycle([*series, None])):
        if number >= kills or time.monotonic() > until_s:
            return
        yield one


def main() -> None:
    """Kill, look, tell; exit code 1 if anything was lost or left behind."""
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(1))
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--kills", type=int, default=KILLS)
    parser.add_argument("--minutes", type=float, default=24 * 60.0)
    options = parser.parse_args()
    until_s, pick = time.monotonic() + 60 * options.minutes, random.Random(0)
    in_window: list[window_kills.Killed] = []
    with tempfile.TemporaryDirectory(prefix="kills-") as root:
        base = make_session(Path(root) / "base", OBJECT)
        series = [Series(job, Path(root) / job.name) for job in jobs(base)]
        for one in _turns(series, options.kills, until_s):
            if one is None:
                in_window.append(_kill_window(pick))
                print(f"window: {in_window[-1]}", flush=True)
                continue
            if not one.seconds:
                one.begin()
            one.kill(pick)
            print(f"{one.job.name}: {one.n_kills} killed, {len(one.problems)} problems", flush=True)
        for one in series:
            if one.seconds:
                one.end()
    sys.exit(not told(series, in_window))


def told(series: list[Series], in_window: list[window_kills.Killed]) -> bool:
    """Print what was killed when, and what was wrong; return whether all was well."""
    for one in series:
        print(f"{one.job.name}: {one.n_kills} kills after {dict(one.moments)}")
        print(*one.problems, sep="\n", end="\n" if one.problems else "")
    found = Counter(tried.found for tried in in_window if tried.in_time)
    print(f"window: {found.total()} kills; then {dict(found)}")
    problems = [problem for one in series for problem in one.problems]
    problems += [tried.problems for tried in in_window if tried.problems]
    n_kills = sum(one.n_kills for one in series) + found.total()
    print(f"{n_kills} kills, {len(problems)} problems")
    return bool(n_kills) and not problems


if __name__ == "__main__":
    main()
