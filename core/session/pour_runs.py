"""The runs of real or rehearsed pours that a session holds: `pours/0001`, `pours/0002` and so on.

A run is no stage: it is written line by line while it happens, so that a crash loses nothing that happened.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from datetime import datetime, timezone
from pathlib import Path
from typing import Any

from core.errors import SessionError
from core.files import read_content, read_json, reason, write_json
from core.formats import check_table, parse_json
from core.formats.tables import Event
from core.formats.tables import Outcome as OutcomeTable
from core.session.explaining import explained

RUNS_FOLDER = "pours"
EVENTS_FILE, STATES_FILE, OUTCOME_FILE = "events.jsonl", "states.csv", "outcome.json"
_EMPTIED_FILE = "emptied.json"


@dataclass(frozen=True)
class Outcome:
    """What became of a run's candies.

    Attributes:
        n_candies: in the cup before; none if nobody counted.
        n_spilled: beside the object; none if nobody counted.
        remarks: in the words of who saw it.
        is_simulated: whether it was simulated, and nobody saw it.
        facts: more numbers, as plain JSON.
    """

    n_candies: int | None
    n_spilled: int | None
    remarks: str
    is_simulated: bool
    facts: dict[str, Any]

    @property
    def sentence(self) -> str:
        """For people."""
        if self.n_spilled is None:
            said = "Nobody counted what was spilled."
        else:
            of = f" of {self.n_candies}" if self.n_candies is not None else ""
            said = f"{self.n_spilled}{of} candies were spilled."
        origin = " (simulated: by physics of its own, over the true object)" if self.is_simulated else ""
        return f"{said[:-1]}{origin}." + (f" {self.remarks}" if self.remarks else "")


@dataclass(frozen=True)
class PourRun:
    """One run, read from its folder.

    Attributes:
        folder: that holds it.
        events: what happened, in its order.
        outcome: what became of the candies; none as long as nobody entered it.
        problem: what of it is damaged, and what follows; empty if nothing is. A run cannot be made anew, so
            what is left of it is kept.
    """

    folder: Path
    events: tuple[dict[str, Any], ...]
    outcome: Outcome | None
    problem: str = ""

    @classmethod
    def load(cls, folder: Path) -> PourRun:
        """Read a run's folder; what is damaged in it is told by `problem`."""
        events, of_events = _read_events(folder / EVENTS_FILE)
        outcome, of_outcome = _read_outcome(folder / OUTCOME_FILE)
        return cls(folder, tuple(events), outcome, " ".join(filter(None, (of_events, of_outcome))))

    @property
    def begun(self) -> str:
        """ISO 8601 time, UTC, of its first event; empty if there is none."""
        return str(self.events[0].get("time", "")) if self.events else ""

    @property
    def imagination(self) -> str:
        """Digest of the imagined pours that it was one of; empty for a way back."""
        return str(self.events[0].get("imagination", "")) if self.events else ""

    @property
    def note(self) -> str:
        """Why it was this pour, if a person had chosen it; else empty."""
        return str(self.events[0].get("note", "")) if self.events else ""

    @property
    def is_back_off(self) -> bool:
        """Whether it was no pour but the way back after one that was stopped."""
        return bool(self.events and self.events[0].get("is_back_off", False))

    @property
    def is_done(self) -> bool:
        """Whether every move was made."""
        return any(event["kind"] == "done" for event in self.events)

    @property
    def was_emptied(self) -> bool:
        """Whether somebody took all candies out of the object after it."""
        return (self.folder / _EMPTIED_FILE).is_file()

    @property
    def sentence(self) -> str:
        """How it ended, for people."""
        if self.is_done:
            return "The arm backed off." if self.is_back_off else "The pour was made."
        stops = [event for event in self.events if event["kind"] == "stopped"]
        if not stops:
            return "The run ended without a word: the program was ended while the arm moved."
        during = [event.get("sentence", "").split(":")[0] for event in self.events if event["kind"] == "move"]
        where = f" during '{during[-1]}'" if during else " before the first move"
        return f"Stopped{where}: {stops[-1].get('sentence', '')}".rstrip(": ")


def pour_runs(session: Path) -> list[PourRun]:
    """Return a session's runs, the oldest first."""
    return [PourRun.load(folder) for folder in _run_folders(session)]


def unfinished_run(runs: Sequence[PourRun]) -> PourRun | None:
    """Return the pour of `runs` (the oldest first) that was stopped and not backed off from since, if any."""
    for run in reversed(runs):
        if run.is_done:
            return None
        if not run.is_back_off:
            return run
    return None


def next_run_folder(session: Path) -> Path:
    """Return the folder for a new run of a session; it is not made."""
    folders = _run_folders(session)
    number = int(folders[-1].name) + 1 if folders else 1
    return session / RUNS_FOLDER / f"{number:04d}"


def write_outcome(folder: Path, outcome: Outcome) -> None:
    """Keep what became of a run's candies.

    Raises:
        SessionError: the folder cannot be written.
    """
    with explained(folder):
        write_json(folder / OUTCOME_FILE, vars(outcome) | {"entered": _now()})


def note_emptied(session: Path) -> None:
    """Keep that somebody has taken all candies out of the object; without a run there were none.

    Raises:
        SessionError: the folder cannot be written.
    """
    for folder in _run_folders(session)[-1:]:
        with explained(folder):
            write_json(folder / _EMPTIED_FILE, {"noted": _now()})


def _now() -> str:
    return datetime.now(timezone.utc).isoformat(timespec="seconds")


def _run_folders(session: Path) -> list[Path]:
    return sorted(path for path in (session / RUNS_FOLDER).glob("[0-9]*") if path.name.isdigit())


def _read_outcome(path: Path) -> tuple[Outcome | None, str]:
    """Return what was entered, and what is wrong with it."""
    if not path.exists():
        return None, ""
    try:
        return Outcome(**read_json(path, OutcomeTable)), ""
    except SessionError as error:
        return None, f"{error} Enter the outcome again."


def _read_events(path: Path) -> tuple[list[dict[str, Any]], str]:
    """Return what was written until something is damaged, and what is wrong.

    A last line without its end is what a crash leaves: nothing is wrong with the others.
    """
    events: list[dict[str, Any]] = []
    try:
        lines = read_content(path).splitlines(keepends=True) if path.exists() else []
    except OSError as error:
        return events, f"{path} cannot be read ({reason(error)}): what happened is not known."
    for number, line in enumerate(lines, 1):
        try:
            check_table(line, Event)
            events.append(parse_json(line))
        except ValueError as error:
            if number == len(lines) and not line.endswith(b"\n"):
                break
            return (
                events,
                f"{path} is damaged in line {number} ({reason(error)}): what came after is not known.",
            )
    return events, ""
