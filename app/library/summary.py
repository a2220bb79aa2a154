"""A session in a list of sessions, summed up from its small files alone."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from datetime import datetime, timezone
from pathlib import Path

from app.library.session_folder import UNFINISHED_SCAN, size_bytes
from app.library.thumbnail import current_thumbnail
from core.errors import PoursightError
from core.formats import excerpt
from core.pipeline.session_view import SessionView
from core.session import StageRecord
from core.session.pour_runs import pour_runs


@dataclass(frozen=True)
class PourScore:
    """P of one pour: `i` its direction, `j` its distance, `p` the share that lands inside, 0 to 1."""

    i: int
    j: int
    p: float


@dataclass(frozen=True)
class SessionSummary:
    """A session on a card. What is not known (yet) is None, or empty.

    Attributes:
        path: its folder.
        name: what people call it.
        created: ISO 8601 time, UTC.
        source: where its data is from, such as "scan of mug, simulated cell".
        n_views: of the scan; 0 without one.
        is_open_container: the verdict.
        omega: Omega (Eq. 1).
        omega_threshold: Omega_thr it was compared with.
        capacity_share: what it holds as a share of its convex hull; None if Omega decided.
        capacity_threshold: what that was compared with.
        is_undecided: whether the verdict depends on what no view saw.
        best: the imagined pour with the largest P; among equals the chosen one.
        chosen: the pour to make: the operator's, else the arm's, else the paper's rule's.
        operator_reason: why the operator chose it; empty if nobody did.
        n_runs: pours that an arm made or began.
        outcome: of the newest run that has one, as a sentence; without any, how the newest run ended.
        n_spilled: candies spilled in it.
        stages: finished ones that belong together, in the order of the work.
        size_bytes: on the disk.
        thumbnail: a picture of 320 x 240; None if it has yet to be made.
        problem: why it, or a pour in it, cannot be read, as a sentence.
    """

    path: Path
    name: str
    created: str
    source: str = ""
    n_views: int = 0
    is_open_container: bool | None = None
    omega: float | None = None
    omega_threshold: float | None = None
    capacity_share: float | None = None
    capacity_threshold: float | None = None
    is_undecided: bool = False
    best: PourScore | None = None
    chosen: PourScore | None = None
    operator_reason: str = ""
    n_runs: int = 0
    outcome: str = ""
    n_spilled: int | None = None
    stages: tuple[str, ...] = ()
    size_bytes: int = 0
    thumbnail: Path | None = None
    problem: str = ""

    @property
    def verdict_words(self) -> str:
        """The verdict in words that a search tells apart; empty as long as there is none."""
        if self.is_open_container is None:
            return ""
        if self.is_undecided:
            return "cannot tell"
        return "open container" if self.is_open_container else "not a container"

    @property
    def created_here(self) -> datetime | None:
        """When it was made, in this computer's time zone; None if that cannot be read."""
        try:
            return datetime.fromisoformat(self.created).astimezone()
        except (OverflowError, ValueError):
            return None


def summarize(folder: Path) -> SessionSummary:
    """Sum up a session; takes a few milliseconds. What cannot be read gets a summary with a `problem`."""
    folder = folder.absolute()
    try:
        return _summarize(folder)
    except PoursightError as error:
        return _unreadable(folder, str(error))
    except OSError as error:
        return _unreadable(folder, f"{error.filename} cannot be read ({error.strerror}); make it readable.")
    except (ArithmeticError, AttributeError, LookupError, RecursionError, TypeError, ValueError) as error:
        said = f"The session {folder} is damaged ({excerpt(repr(error))}); run its stages again or delete it."
        return _unreadable(folder, said)


def _summarize(folder: Path) -> SessionSummary:
    view = SessionView.of(folder)
    judged = view.verdict
    by_capacity = judged.verdict if judged is not None else None
    best, chosen = _scores(view)
    operator = view.operator if view.pours is not None else None
    runs = [run for run in pour_runs(folder) if not run.is_back_off]
    outcomes = [run.outcome for run in runs if run.outcome is not None]
    return SessionSummary(
        path=folder,
        name=view.session.name,
        created=view.session.created,
        source=_source(folder, view.records),
        n_views=_n_views(view.records),
        is_open_container=judged.is_open_container if judged is not None else None,
        omega=judged.omega if judged is not None else None,
        omega_threshold=judged.omega_threshold if judged is not None else None,
        capacity_share=by_capacity.capacity_share if by_capacity is not None else None,
        capacity_threshold=by_capacity.threshold if by_capacity is not None else None,
        is_undecided=judged is not None and judged.is_undecided,
        best=best,
        chosen=chosen,
        operator_reason=operator.reason if operator is not None else "",
        n_runs=len(runs),
        outcome=outcomes[-1].sentence if outcomes else runs[-1].sentence if runs else "",
        n_spilled=outcomes[-1].n_spilled if outcomes else None,
        stages=tuple(view.records),
        size_bytes=size_bytes(folder),
        thumbnail=current_thumbnail(folder, view.records),
        problem=next((run.problem for run in runs if run.problem), ""),
    )


def _unreadable(folder: Path, problem: str) -> SessionSummary:
    try:
        changed_s = folder.stat().st_mtime
    except OSError:
        changed_s = 0.0
    created = datetime.fromtimestamp(changed_s, timezone.utc).isoformat(timespec="seconds")
    return SessionSummary(folder, folder.name, created, problem=problem)


def _source(folder: Path, records: Mapping[str, StageRecord]) -> str:
    if "mesh" in records:
        return f"mesh {_file_name(records['mesh'])}".rstrip()
    if "scan" not in records:
        return "unfinished scan" if (folder / UNFINISHED_SCAN).is_dir() else ""
    scan = records["scan"]
    cell = scan.parameters.get("cell")
    if cell is None:
        return f"imported scan {_file_name(scan)}".rstrip()
    thing = scan.parameters.get("object")
    return f"scan of {Path(thing).name}, {cell['name']}" if thing else f"scan, {cell['name']}"


def _file_name(record: StageRecord) -> str:
    return Path(record.parameters.get("source", "")).name


def _n_views(records: Mapping[str, StageRecord]) -> int:
    return sum(name.endswith(".color.png") for name in records["scan"].files) if "scan" in records else 0


def _scores(view: SessionView) -> tuple[PourScore | None, PourScore | None]:
    """Return the best and the chosen pour."""
    if view.pours is None:
        return None, None
    p, place = view.pours.p, view.place
    chosen = None if place is None else PourScore(*place, p[place[0]][place[1]])
    scores = [PourScore(i, j, ratio) for i, row in enumerate(p) for j, ratio in enumerate(row)]
    return max(scores, key=lambda score: (score.p, score == chosen)), chosen
