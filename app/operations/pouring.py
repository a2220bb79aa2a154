"""Pouring: from the imagined pours to candies in the object, with an operator who confirms every motion."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Protocol

from app.operations.arm import ArmOperator, connected, recover
from app.operations.choosing import described_cell, refuse_unfeasible
from core.errors import Cancelled, InputError, MotionError, PoursightError, Remedy, StageError
from core.imagination.advice import advice_against
from core.imagination.amount.result import Amount
from core.imagination.results import PourGrid
from core.motion.pour.cell import PourCell
from core.motion.pour.feasibility import PourMotions
from core.motion.pour.plan import PlannedMove, PourPlan, PourTarget
from core.pipeline.pipeline import Pipeline
from core.pipeline.session_view import SessionView
from core.report import motion_sentence, operator_sentence, pours_sentence
from core.session import Session
from core.session.cups import Cup, next_cup
from core.session.operator_choice import read_operator_choice
from core.session.pour_runs import Outcome, pour_runs, write_outcome
from hardware.cell import CellSettings, open_arm, read_cell
from hardware.cell.scene import pour_cell
from hardware.errors import DeviceError
from hardware.pouring.pouring import Pouring

if TYPE_CHECKING:
    from core.imagination.imagination import Imagination


@dataclass(frozen=True)
class PreparedPour:
    """What can be poured into the session's object, and in which cell.

    Attributes:
        settings: the cell.
        cell: the same as the planner sees it.
        grid: the imagined pours.
        motions: which of them the arm can make.
        target: the chosen one; none if the arm can make none.
        advice: why it should rather not be poured; empty if nothing speaks against it, or a person chose the
            pour.
        amount: how many candies shall go in; none if it is not known what the object holds.
        n_per_cup: candies in each cup to be poured.
    """

    settings: CellSettings
    cell: PourCell
    grid: PourGrid
    motions: PourMotions
    target: PourTarget | None
    advice: str
    amount: Amount | None
    n_per_cup: tuple[int, ...]

    @property
    def sentence(self) -> str:
        """Which of the pours the arm can make, and which one is chosen."""
        return motion_sentence(self.motions, self.grid)

    def chosen(self) -> PourTarget:
        """Return the pour to make.

        Raises:
            MotionError: the arm can make none.
        """
        if self.target is None:
            raise MotionError(self.sentence)
        return self.target


class Operator(ArmOperator, Protocol):
    """The person at the arm that pours."""

    def prepared(self, prepared: PreparedPour) -> None:
        """Which pour will be made."""
        ...

    def confirm_doubtful(self, advice: str) -> None:
        """Whether it shall be poured although it is not advised."""
        ...

    def confirm_pour(self, plan: PourPlan, note: str, robot: str, cup: Cup) -> None:
        """Whether a robot shall pour a cup as planned; `note` says why it is this pour."""
        ...

    def confirm_opening(self, gripper: str) -> None:
        """Whether a gripper that was found closed shall open where it is; the pour is planned from there."""
        ...

    def confirm_back_off(self, moves: Sequence[PlannedMove]) -> None:
        """Whether the arm shall back off, with the cup, along its checked path."""
        ...

    def backed_off(self) -> None:
        """The arm is home; the next pour is planned again."""
        ...

    def counted(self, cup: Cup) -> Outcome | None:
        """What became of the candies of a real pour; none if nobody counted them."""
        ...

    def poured(self, outcome: Outcome) -> None:
        """What became of the candies."""
        ...


def prepare(pipeline: Pipeline, settings: CellSettings) -> PreparedPour:
    """Imagine what is stale and judge which pours the arm of a cell can make.

    Raises:
        StageError: the object is no open container, or more is to be poured than fits.
        MotionError: the arm cannot take the cup at all.
    """
    session = pipeline.session
    if session.record("mesh") is not None:
        raise InputError(
            f"The session {session.path} holds a mesh, so it is not known where the object is in a cell.",
            Remedy.SCAN_THE_MESH,
        )
    cell = pour_cell(settings)
    imagination = pipeline.imagination()
    if imagination.amount is not None and imagination.amount.refusal:
        raise StageError(f"Nothing is poured. {imagination.amount.refusal}")
    motions = pipeline.motion(cell, described_cell(settings))
    if motions is None or imagination.grid is None:
        reason = pours_sentence(imagination.containability, imagination.grid, imagination.choice)
        raise StageError(f"There is no pour to make. {reason}")
    target = _target(pipeline, imagination, motions)
    advice = _advice(pipeline, imagination, motions, target)
    amount, n_per_cup = imagination.amount, imagination.n_per_cup
    return PreparedPour(settings, cell, imagination.grid, motions, target, advice, amount, n_per_cup)


def cell_of(session: Session, cell_file: Path | None) -> CellSettings:
    """Return the cell that was named, else the one of the scan, else the simulated one."""
    if cell_file is not None:
        return read_cell(cell_file)
    record = session.record("scan")
    if record is not None and "cell" in record.parameters:
        return CellSettings.model_validate(record.parameters["cell"])
    return read_cell()


def pour(pipeline: Pipeline, settings: CellSettings, operator: Operator) -> Path:
    """Plan, ask, pour, cup after cup; after a stop offer to back off and to pour again.

    Of several cups it begins with the first that was not poured yet. Returns the last run's folder.

    Raises:
        PoursightError: the sentence says what is in the way.
    """
    prepared = prepare(pipeline, settings)
    target = prepared.chosen()
    operator.prepared(prepared)
    if prepared.advice:
        operator.confirm_doubtful(prepared.advice)
    session = pipeline.session.path
    cups = prepared.n_per_cup
    if len(cups) > 1 and not operator.is_present and not settings.has_simulated_object:
        raise InputError(
            f"{len(cups)} cups are to be poured, and nobody would fill them; pour with an operator at the "
            "arm, or pour less."
        )
    with connected(open_arm(settings), operator) as arm:
        if arm.gripper.is_closed and operator.is_present:
            # left by an earlier program, whose plan to back off along is gone with it
            operator.confirm_opening(arm.gripper.name)
            arm.gripper.open()
        pouring = Pouring(arm, prepared.cell, target, session, pipeline.reporter)
        while True:
            cup = next_cup(session, target.digest, cups)
            folder = pour_cup(pouring, operator, arm.robot.name, cup)
            _record_outcome(pipeline, operator, settings, folder, cup)
            if cup.number == cup.n_cups:
                return folder


def was_poured(session: Session) -> bool:
    """Whether what is imagined now was poured already, all cups of it, and the outcome recorded."""
    pours = SessionView(session).pours
    if pours is None:
        return False
    made = [run for run in pour_runs(session.path) if run.is_done and run.outcome is not None]
    is_over = next_cup(session.path, pours.digest, pours.n_per_cup).number == 1
    return is_over and any(run.imagination == pours.digest for run in made)


def _target(pipeline: Pipeline, imagination: Imagination, motions: PourMotions) -> PourTarget | None:
    record, grid = pipeline.session.record("pouring"), imagination.grid
    assert record is not None and grid is not None, "the pours were imagined"
    operator = read_operator_choice(pipeline.session.path, record.digest)
    if operator is not None:
        refuse_unfeasible(operator, grid, motions)
    choice = operator or motions.choice
    if choice is None:
        return None
    return PourTarget(
        imagination.containability.aabb_m,
        choice.i,
        choice.j,
        float(grid.theta_rad[choice.i]),
        grid.pivot_m[choice.i, choice.j],
        pipeline.poured_parameters().pouring,
        record.digest,
        "" if operator is None else operator_sentence(operator, grid, motions.choice),
    )


def _advice(
    pipeline: Pipeline, imagination: Imagination, motions: PourMotions, target: PourTarget | None
) -> str:
    """Who chooses a pour and gives a reason has made up his mind."""
    if target is None or target.note:
        return ""
    risk = motions.risk or imagination.risk
    return advice_against(risk, target.i, target.j, pipeline.parameters.risk.wanted_clean)


def pour_cup(pouring: Pouring, operator: Operator, robot: str, cup: Cup) -> Path:
    """Plan, ask and pour until one cup is poured; return its run's folder."""
    while True:
        fresh = pouring.plan()
        operator.confirm_pour(fresh.plan, fresh.target.note, robot, cup)
        try:
            return pouring.carry_out(fresh)
        except (DeviceError, Cancelled) as error:
            if not (operator.is_present and pouring.is_interrupted):
                raise
            _recover(operator, pouring, error)


def _recover(operator: Operator, pouring: Pouring, error: PoursightError) -> None:
    """Step by step, each confirmed: make the arm ready, back off with the cup, then plan again."""
    while pouring.is_interrupted:
        recover(pouring, pouring.robot, operator, error)
        moves = pouring.plan_back_off()
        operator.confirm_back_off(moves)
        try:
            pouring.back_off(moves)
        except (DeviceError, Cancelled) as again:  # stopped once more, on the way back
            error = again
    operator.backed_off()


def _record_outcome(
    pipeline: Pipeline, operator: Operator, settings: CellSettings, folder: Path, cup: Cup
) -> None:
    if settings.has_simulated_object:
        from app.operations.outcome import simulated_outcome

        outcome: Outcome | None = simulated_outcome(pipeline, settings, folder)
    else:
        outcome = operator.counted(cup)
    if outcome is not None:
        write_outcome(folder, outcome)
        operator.poured(outcome)
