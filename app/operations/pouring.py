"""Pouring: from the imagined pours to candies in the object, with an operator who confirms every motion."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Protocol

from app.operations.arm import ArmOperator, connected, recover
from app.operations.choosing import described_cell, refuse_unfeasible
from core.errors import Cancelled, InputError, MotionError, Remedy, StageError
from core.imagination.advice import advice_against
from core.imagination.amount.result import Amount
from core.imagination.results import PourGrid
from core.motion.pour.cell import PourCell
from core.motion.pour.feasibility import PourMotions
from core.motion.pour.plan import PlannedMove, PourPlan, PourTarget
from core.parameters.bodies import CupParameters
from core.pipeline.pipeline import Pipeline
from core.pipeline.session_view import SessionView
from core.progress import Reporter
from core.report import motion_sentence, operator_sentence, pours_sentence
from core.session import Session
from core.session.cups import Cup, next_cup
from core.session.operator_choice import read_operator_choice
from core.session.pour_runs import Outcome, pour_runs, write_outcome
from hardware.cell import CellSettings, open_arm, read_cell
from hardware.cell.scene import pour_cell
from hardware.errors import DeviceError, MoveRefused, RobotError
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


class CupOperator(ArmOperator, Protocol):
    """The person at an arm that takes a cup and brings it back."""

    def confirm_pour(self, plan: PourPlan, note: str, robot: str, cup: Cup) -> None:
        """Whether a robot shall pour a cup as planned; `note` says why it is this pour."""
        ...

    def is_cup_in_hand(self, known: str) -> bool:
        """Whether a gripper that was found closed holds the cup of an earlier run; `known` says which."""
        ...

    def confirm_opening(self, gripper: str, known: str) -> None:
        """Whether a closed gripper shall open where it is; the pour is planned from there."""
        ...

    def confirm_back_off(self, moves: Sequence[PlannedMove]) -> None:
        """Whether the arm shall back off, with the cup, along its checked path."""
        ...

    def backed_off(self) -> None:
        """The arm is home; the next pour is planned again."""
        ...


class Operator(CupOperator, Protocol):
    """The person at the arm that pours."""

    def prepared(self, prepared: PreparedPour) -> None:
        """Which pour will be made."""
        ...

    def confirm_doubtful(self, advice: str) -> None:
        """Whether it shall be poured although it is not advised."""
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
        InputError: the session holds a mesh, or the cell's cup is not the one that was imagined.
        StageError: the object is no open container, or more is to be poured than fits.
        MotionError: the arm cannot take the cup at all.
    """
    session = pipeline.session
    if session.record("mesh") is not None:
        raise InputError(
            f"The session {session.path} holds a mesh, so it is not known where the object is in a cell.",
            Remedy.SCAN_THE_MESH,
        )
    _refuse_other_cup(settings, pipeline.parameters.pouring.cup)
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
    with connected(open_arm(settings), operator, pipeline.reporter) as arm:
        if arm.gripper.is_closed and operator.is_present:
            # for the cell as it is: at whatever speed that run was planned
            empty_hand(Pouring(arm, prepared.cell, target, session, pipeline.reporter), operator)
        while True:
            cell = cell_to_pour_in(prepared, session, pipeline.reporter)
            pouring = Pouring(arm, cell, target, session, pipeline.reporter)
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


def _refuse_other_cup(settings: CellSettings, imagined: CupParameters) -> None:
    """What was imagined with one cup says nothing of another, and the hand would take it in another place."""
    cup = settings.cup
    if cup is None or cup == imagined:
        return
    held = imagined.model_dump()
    changes = ", ".join(
        f"pouring.cup.{name} = {value:.6g}" for name, value in cup.model_dump().items() if value != held[name]
    )
    raise InputError(
        f"The cup of the {settings.name} is not the one that was imagined; imagine again with {changes}."
    )


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


def cell_to_pour_in(prepared: PreparedPour, session: Path, reporter: Reporter) -> PourCell:
    """The cell as the planner sees it; slower, which is said, for a real arm's first pour in a session."""
    cell, share = prepared.cell, prepared.cell.limits.first_pour_speed
    if not prepared.settings.robot.is_real or any(
        run.is_done and not run.is_back_off for run in pour_runs(session)
    ):
        return cell
    if share < 1:
        reporter.warn(
            f"The first pour of a session is made at {share:.0%} of the speed, except for the pour rotation "
            "(motion.first_pour_speed in the cell file)."
        )
    slower = {name: share * getattr(cell.limits, name) for name in ("joint_speed_rad_s", "tool_speed_m_s")}
    return replace(cell, limits=cell.limits.model_copy(update=slower))


def pour_cup(pouring: Pouring, operator: CupOperator, robot: str, cup: Cup) -> Path:
    """Plan, ask and pour until one cup is poured; return its run's folder."""
    while True:
        fresh = pouring.plan()
        operator.confirm_pour(fresh.plan, fresh.target.note, robot, cup)
        try:
            return pouring.carry_out(fresh)
        except (DeviceError, Cancelled) as error:
            if not (operator.is_present and pouring.is_interrupted):
                raise
            recover(pouring, pouring.robot, operator, error)
            _return(operator, pouring)


def empty_hand(pouring: Pouring, operator: CupOperator) -> None:
    """Find out what an earlier program left in the closed hand, and get rid of it; the operator decides."""
    known = pouring.take_up()
    if known and operator.is_cup_in_hand(known):
        _return(operator, pouring)
    else:
        operator.confirm_opening(pouring.gripper, known)
        pouring.give_up_way_back()


def _return(operator: CupOperator, pouring: Pouring) -> None:
    """Let an arm that is ready back off with the cup, as often as it is stopped; then it can plan again.

    Where the arm was pushed off its checked path, or its controller does not allow that path any more, there
    is no way back along it: somebody takes what is in the hand, and the next plan begins where the arm is.
    """
    while pouring.is_interrupted:
        try:
            moves = pouring.plan_back_off()
        except (MotionError, MoveRefused) as error:
            operator.confirm_opening(pouring.gripper, str(error))
            pouring.give_up_way_back()
            return
        except RobotError as error:  # such as a slider at 0, or an arm that was stopped meanwhile
            recover(pouring, pouring.robot, operator, error)
            continue
        operator.confirm_back_off(moves)
        try:
            pouring.back_off(moves)
        except (DeviceError, Cancelled) as again:  # stopped once more, on the way back
            recover(pouring, pouring.robot, operator, again)
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
