"""What a session holds, read for those who look at it: one read model, in typed parts, nothing is run.

Unlike freshness it does not ask which parameters somebody would use today: what was found with other ones is
still what was found.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

from core.errors import InputError, Remedy, SessionError
from core.files import read_json, reading
from core.imagination.amount.result import AMOUNT_FILE, Amount, PlannedAmount
from core.imagination.choice import choose_pour
from core.imagination.judgement import Judgement
from core.imagination.results import DROP_FILE, POURS_FILE, Containability, Drop, PourChoice, PourGrid
from core.imagination.retention.result import RETENTION_FILE, Retention
from core.imagination.risk.tries import Tries
from core.imagination.verdict import Verdict
from core.motion.pour.feasibility import MOTION_FILE, PourMotions
from core.parameters import Parameters, apply_settings
from core.pipeline.freshness import finished_records
from core.quality.verdict_words import FACTS_FILE
from core.session import Session, StageRecord
from core.session.operator_choice import OperatorChoice, damaged_choice, read_operator_choice
from core.stages import MESH, recorded_settings

IMAGINED = ("containability", "judgement", "amount", "pouring", "risk")
"""The stages that lead to the chosen pour, in their order."""
ALL_IMAGINED = (*IMAGINED, "retention")
"""With what no pour waits for: how firmly the object holds."""


@dataclass(frozen=True)
class VerdictFacts:
    """The verdict on an object, in numbers.

    Attributes:
        is_open_container: the verdict.
        omega: Omega (Eq. 1).
        omega_threshold: Omega_thr.
        n_drop: candies dropped.
        n_in: of these, candies that stayed.
        verdict: by what the object holds; none if Omega decided.
    """

    is_open_container: bool
    omega: float
    omega_threshold: float
    n_drop: int
    n_in: int
    verdict: Verdict | None

    @property
    def is_undecided(self) -> bool:
        """Whether the verdict depends on what no view saw."""
        return self.verdict is not None and self.verdict.is_undecided


@dataclass(frozen=True)
class PoursFacts:
    """The imagined pours, in numbers.

    Attributes:
        digest: of the imagined pours: runs and choices of operators name it.
        n_pour: N_pour.
        n_per_cup: candies in each cup to be poured.
        p: [i][j] particle-in-object ratio P.
        theta_rad: directions of the pours.
        indent_m: distances of the pivots from the footprint's centre.
        choice: (i, j) of the pour that the program would make: the arm's where it was asked; none if the arm
            can make none.
    """

    digest: str
    n_pour: int
    n_per_cup: tuple[int, ...]
    p: tuple[tuple[float, ...], ...]
    theta_rad: tuple[float, ...]
    indent_m: tuple[float, ...]
    choice: tuple[int, int] | None


class SessionView:
    """One session, read from its files; each part is read when first asked for, and none if it is not there.

    Raises:
        SessionError: on access of a part whose files are damaged; the sentence names the file.
    """

    def __init__(self, session: Session, records: Mapping[str, StageRecord] | None = None) -> None:
        """Look at a session; `finished_records` of its folder need not be read again if they are at hand."""
        self.session = session
        if records is not None:
            self.finished = records

    @classmethod
    def of(cls, folder: Path) -> SessionView:
        """Open a session to look at it.

        Raises:
            SessionError: the folder is no session.
        """
        return cls(Session.open(folder))

    @cached_property
    def finished(self) -> Mapping[str, StageRecord]:
        """The records of all finished stages, whatever they were made from."""
        return finished_records(self.session.path)

    @cached_property
    def records(self) -> Mapping[str, StageRecord]:
        """The records of the finished stages made from what the session holds now, in their order."""
        return current_records(self.session.path, self.finished)

    @cached_property
    def scan_verdict(self) -> str:
        """How good the scan is, one of `core.quality.verdict_words.VERDICTS`; empty if it was not checked."""
        if "quality" not in self.records:
            return ""
        path = self._path("quality") / FACTS_FILE
        table = read_json(path)
        with reading(path):
            return str(table["verdict"])

    @cached_property
    def verdict(self) -> VerdictFacts | None:
        """The verdict in numbers."""
        if "containability" not in self.records:
            return None
        path = self._path("containability") / DROP_FILE
        drop, judged = read_json(path), self._judgement_table()
        if judged is None:
            return None
        with reading(path):
            verdict = None if judged.get("verdict") is None else Verdict.from_table(judged["verdict"])
            omega, threshold = float(drop["omega"]), float(judged["omega_threshold"])
            is_container = omega > threshold if verdict is None else verdict.is_container
            return VerdictFacts(
                is_container, omega, threshold, int(drop["n_drop"]), int(drop["n_in"]), verdict
            )

    @cached_property
    def pours(self) -> PoursFacts | None:
        """The pours in numbers."""
        record = self.records.get("pouring")
        if record is None or POURS_FILE not in record.files or not self._has_choice:
            return None
        path = self._path("pouring") / POURS_FILE
        table = read_json(path)
        with reading(path):
            return PoursFacts(
                record.digest,
                int(table["n_pour"]),
                PlannedAmount(int(table["n_pour"]), self.amount).n_per_cup,
                tuple(tuple(map(float, row)) for row in table["p"]),
                tuple(map(float, table["theta_rad"])),
                tuple(map(float, table["indent_m"])),
                self._choice_place(len(table["theta_rad"]), len(table["indent_m"])),
            )

    @cached_property
    def operator(self) -> OperatorChoice | None:
        """What a person chose among these pours; none if nobody did."""
        record = self.records.get("pouring")
        chosen = None if record is None else read_operator_choice(self.session.path, record.digest)
        if chosen is not None and self.pours is not None:
            try:
                check_place(chosen.i, chosen.j, len(self.pours.p), len(self.pours.indent_m))
            except ValueError as error:
                raise damaged_choice(self.session.path) from error
        return chosen

    @property
    def place(self) -> tuple[int, int] | None:
        """(i, j) of the pour that will be made: a person's, else the program's; none if there is none."""
        if self.operator is not None:
            return self.operator.i, self.operator.j
        return None if self.pours is None else self.pours.choice

    @cached_property
    def amount(self) -> Amount | None:
        """What was reasoned of the amount; none if it is not known what the object holds."""
        if "amount" in self.records:
            return PlannedAmount.load(self._path("amount")).amount
        former = self._path("pouring") / AMOUNT_FILE  # of an earlier version
        return Amount.from_table(read_json(former)) if former.is_file() else None

    @cached_property
    def judgement(self) -> Judgement | None:
        """What followed from the drop, with the capacity."""
        table = self._judgement_table()
        if table is None:
            return None
        folder = self._path("judgement" if "judgement" in self.records else "containability")
        with reading(folder):
            return Judgement.from_table(table, folder)

    @cached_property
    def retention(self) -> Retention | None:
        """How firmly the object holds; none if it was not tilted."""
        for name in ("retention", "judgement", "containability"):  # earlier versions kept it with the verdict
            folder = self._path(name)
            if name in self.records and (folder / RETENTION_FILE).is_file():
                with reading(folder):
                    return Retention.load(folder)
        return None

    @cached_property
    def drop(self) -> Drop | None:
        """The drop, whether or not it is judged."""
        if "containability" not in self.records:
            return None
        folder = self._path("containability")
        with reading(folder):
            return Drop.load(folder)

    @cached_property
    def containability(self) -> Containability | None:
        """The drop with its verdict."""
        if self.drop is None or self.judgement is None:
            return None
        return self.judgement.of(self.drop)

    @cached_property
    def grid(self) -> PourGrid | None:
        """The pours with their recordings."""
        if self.pours is None:
            return None
        folder = self._path("pouring")
        with reading(folder):
            return PourGrid.load(folder)

    @cached_property
    def tries(self) -> Tries | None:
        """What was tried of the pours, and the choice of the imagination alone."""
        if not self._has_choice:
            return None
        folder = self._tries_folder
        with reading(folder):
            return Tries.load(folder)

    @cached_property
    def paper_choice(self) -> PourChoice | None:
        """What the paper's rule says."""
        cup = self.parameters_of("pouring").pouring.cup if self.grid is not None else None
        return None if self.grid is None or cup is None else choose_pour(self.grid, cup)

    @cached_property
    def motions(self) -> PourMotions | None:
        """Which of the pours some cell's arm can make, if it was asked about these pours."""
        if "motion" not in self.records or MOTION_FILE not in self.records["motion"].files:
            return None
        folder = self._path("motion")
        with reading(folder):
            return PourMotions.load(folder)

    def parameters_of(self, name: str) -> Parameters:
        """Return the parameters with the values that a stage was run with; of others the defaults.

        Raises:
            SessionError: the stage was run by another version, whose parameters are not known.
        """
        recorded = recorded_settings(name, self.records[name].parameters)
        try:
            return apply_settings(Parameters(), recorded)
        except InputError as error:
            raise SessionError(
                f"The stage '{name}' of {self.session.path} was run by another version of Poursight.",
                Remedy.RUN_AGAIN,
            ) from error

    @property
    def source(self) -> str:
        """The stage that gives the surface."""
        return MESH if MESH in self.records else "reconstruction"

    def _path(self, name: str) -> Path:
        return self.session.path / name

    def _judgement_table(self) -> dict[str, Any] | None:
        if "containability" not in self.records:
            return None
        if "judgement" in self.records:
            table: dict[str, Any] = read_json(self._path("judgement") / "judgement.json")
            return table
        former: dict[str, Any] = read_json(self._path("containability") / DROP_FILE)
        return former if "omega_threshold" in former else None  # an earlier version kept it with the drop

    @property
    def _tries_folder(self) -> Path:
        return self._path("risk" if "risk" in self.records else "pouring")

    @property
    def _has_choice(self) -> bool:
        record = self.records.get("risk") or self.records.get("pouring")
        return record is not None and "choice.json" in record.files

    def _choice_place(self, n_directions: int, n_distances: int) -> tuple[int, int] | None:
        if self.motions is not None:
            choice = self.motions.choice
        else:
            choice = self.tries.choice if self.tries is not None else None
        if choice is None:
            return None
        check_place(choice.i, choice.j, n_directions, n_distances)
        return choice.i, choice.j


def check_place(i: int, j: int, n_directions: int, n_distances: int) -> None:
    """Hold a choice against the pours that there are.

    Raises:
        ValueError: it is none of them.
    """
    if not (0 <= i < n_directions and 0 <= j < n_distances):
        raise ValueError(f"the chosen pour {i}, {j} is none of {n_directions} x {n_distances}")


def current_records(
    session: Path, finished: Mapping[str, StageRecord] | None = None
) -> dict[str, StageRecord]:
    """Return the records of the finished stages made from what the session holds now, in their order.

    Args:
        session: the session's folder.
        finished: its `finished_records` if they are at hand.
    """
    current: dict[str, StageRecord] = {}
    for name, record in (finished_records(session) if finished is None else finished).items():
        if _is_made_from(record.inputs, current):
            current[name] = record
    return current


def _is_made_from(inputs: Mapping[str, str], current: Mapping[str, StageRecord]) -> bool:
    return all(name in current and current[name].digest == digest for name, digest in inputs.items())
