"""`poursight plan` and `poursight pour`: from the imagined pours to candies in the object."""

from __future__ import annotations

import sys
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from app.choosing import refuse_unmakeable
from app.motion_record import described_cell
from app.terminal import TerminalReporter
from core.errors import Cancelled, InputError, MotionError, StageError
from core.imagination.amount.result import Amount, imagined_cups
from core.imagination.amount.words import amount_text
from core.imagination.results import PourGrid
from core.motion.pour.cell import PourCell
from core.motion.pour.choosing import PourMotions
from core.motion.pour.plan import PlannedMove, PourPlan
from core.pipeline.pipeline import Pipeline
from core.report import motion_sentence, operator_sentence, pours_sentence
from core.session import Session
from core.session.cups import Cup, next_cup
from core.session.operator_choice import read_operator_choice
from core.session.pour_runs import Outcome, pour_runs, write_outcome
from hardware.cell import CellSettings, open_arm, read_cell
from hardware.cell.scene import pour_cell
from hardware.errors import DeviceError
from hardware.pouring.pouring import Pouring, PourTarget

if TYPE_CHECKING:
    from core.imagination.imagine import Imagination

MM = 1000.0


@dataclass(frozen=True)
class PreparedPour:
    """What can be poured into the session's object, and in which cell.

    Attributes:
        settings: the cell.
        cell: the same as the planner sees it.
        grid: the imagined pours.
        motions: which of them the arm can make.
        target: the chosen one; none if the arm can make none.
        amount: how many candies shall go in; none if it is not known what the object holds.
    """

    settings: CellSettings
    cell: PourCell
    grid: PourGrid
    motions: PourMotions
    target: PourTarget | None
    amount: Amount | None


def prepare(pipeline: Pipeline, settings: CellSettings) -> PreparedPour:
    """Imagine what is stale and judge which pours the arm of a cell can make.

    Raises:
        StageError: the object is no open container, or more is to be poured than fits.
        MotionError: the arm cannot take the cup at all.
    """
    session = pipeline.session
    if session.record("mesh") is not None:
        raise InputError(
            f"The session {session.path} holds a mesh, which stands in no cell; scan it: 'poursight scan "
            "--object MESH --session DIR' does so in the simulated cell."
        )
    cell = pour_cell(settings)
    imagination = pipeline.imagination()
    if imagination.amount is not None and imagination.amount.refusal:
        raise StageError(f"Nothing is poured. {imagination.amount.refusal}")
    motions = pipeline.motion(cell, described_cell(settings))
    if motions is None or imagination.grid is None:
        said = pours_sentence(imagination.containability, imagination.grid, imagination.choice)
        raise StageError(f"There is no pour to make. {said}")
    target = _target(pipeline, imagination, motions)
    return PreparedPour(settings, cell, imagination.grid, motions, target, imagination.amount)


def plan(pipeline: Pipeline, cell_file: Path | None) -> None:
    """Say which pours the arm can make, and what the chosen one looks like from home."""
    task = prepare(pipeline, cell_of(pipeline.session, cell_file))
    target = _chosen(task)
    found = target.plan(task.cell, task.cell.home_rad)
    print(motion_sentence(task.motions, task.grid))
    print("\n".join(plan_lines(found, target.note)))


def pour(pipeline: Pipeline, operator: TerminalReporter | None, cell_file: Path | None) -> Path:
    """Plan, ask, pour, cup after cup; after a stop offer to back off and to pour anew.

    Of several cups it begins with the first that was not poured yet. Returns the last run's folder.

    Args:
        pipeline: of the session.
        operator: who is asked; none (`--yes`): everything is confirmed, and a stopped run ends the command.
        cell_file: the cell; none: the one the object was scanned in.

    Raises:
        PoursightError: the sentence says what is in the way.
    """
    task = prepare(pipeline, cell_of(pipeline.session, cell_file))
    target = _chosen(task)
    print(motion_sentence(task.motions, task.grid))
    if task.amount is not None:
        print(amount_text(task.amount))
    cups = imagined_cups(pipeline.session.path / "pouring")
    if len(cups) > 1 and operator is None and not task.settings.is_simulated:
        raise InputError(
            f"{len(cups)} cups are to be poured, and nobody would fill them: leave --yes out, or pour less."
        )
    with open_arm(task.settings) as arm:
        pouring = Pouring(arm, task.cell, target, pipeline.session.path, pipeline.reporter)
        while True:
            cup = next_cup(pipeline.session.path, target.digest, cups)
            folder = _pour_cup(pouring, operator, arm.robot.name, cup)
            _keep_outcome(pipeline, operator, task.settings, folder, cup)
            if cup.number == cup.n_cups:
                return folder


def was_poured(session: Session) -> bool:
    """Whether what is imagined now was poured already, all cups of it, and the outcome kept."""
    record = session.record("pouring")
    if record is None:
        return False
    made = [run for run in pour_runs(session.path) if run.is_done and run.outcome is not None]
    cups = imagined_cups(session.path / "pouring")
    is_over = bool(cups) and next_cup(session.path, record.digest, cups).number == 1
    return is_over and any(run.imagination == record.digest for run in made)


def plan_lines(plan: PourPlan, note: str = "") -> list[str]:
    """Return a plan for people: why it is this pour, its moves, their times, and what stays free."""
    lines = [note] if note else []
    lines.append(f"The plan, {plan.duration_s:.0f} s:")
    lines += [f"  {move.name:<14}{move.trajectory.duration_s:6.1f} s{_grip(move)}" for move in plan.moves]
    slower_s = plan.turn_s - plan.imagined_turn_s
    slower = f", {slower_s:.1f} s of it for speeding up" if slower_s > 0.05 else ""
    lines.append(f"The turn takes {plan.turn_s:.1f} s{slower} (imagined {plan.imagined_turn_s:.1f} s).")
    lines.append(
        f"What stays free: {plan.clearance_m * MM:.0f} mm between {plan.nearest[0]} and {plan.nearest[1]}; "
        f"{plan.cup_clearance_m * MM:.0f} mm around the cup. The pivot stays within "
        f"{plan.pivot_error_m * MM:.3f} mm."
    )
    return lines


def _grip(move: PlannedMove) -> str:
    return "" if move.gripper_after is None else f", then {move.gripper_after} the gripper"


def _chosen(task: PreparedPour) -> PourTarget:
    if task.target is None:
        raise MotionError(motion_sentence(task.motions, task.grid))
    return task.target


def _target(pipeline: Pipeline, imagination: Imagination, motions: PourMotions) -> PourTarget | None:
    record, grid = pipeline.session.record("pouring"), imagination.grid
    assert record is not None and grid is not None, "the pours were imagined"
    operator = read_operator_choice(pipeline.session.path, record.digest)
    if operator is not None:
        refuse_unmakeable(operator, grid, motions)
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


def cell_of(session: Session, cell_file: Path | None) -> CellSettings:
    """The cell that was named, else the one of the scan, else the simulated one."""
    if cell_file is not None:
        return read_cell(cell_file)
    record = session.record("scan")
    if record is not None and "cell" in record.parameters:
        return CellSettings.model_validate(record.parameters["cell"])
    return read_cell()


def _pour_cup(pouring: Pouring, operator: TerminalReporter | None, robot: str, cup: Cup) -> Path:
    """Plan, ask and pour until a pour is made; returns its run's folder."""
    while True:
        fresh = pouring.plan()
        print("\n".join(plan_lines(fresh.plan, fresh.target.note)))
        _confirm(operator, f"Let the {robot} pour{f' ({cup.words})' if cup.words else ''}?")
        try:
            return pouring.carry_out(fresh)
        except (DeviceError, Cancelled) as error:
            if operator is None or not pouring.is_interrupted:
                raise
            _recover(operator, pouring, error)


def _confirm(operator: TerminalReporter | None, question: str) -> None:
    if operator is None:
        return
    if not sys.stdin.isatty():
        raise InputError("Nothing moves without a confirmation: run it on a terminal, or add --yes.")
    if not operator.ask(question):
        raise Cancelled("Not confirmed; nothing moved.")


def _recover(operator: TerminalReporter, pouring: Pouring, error: Exception) -> None:
    """Step by step, each confirmed: make the arm ready, back off with the cup, then plan anew."""
    operator.forget_cancel()
    said = "Stopped on request." if isinstance(error, Cancelled) else f"Stopped: {error}"
    print(said, file=sys.stderr)
    _confirm(operator, "Put right what stopped it. Then: make the arm ready again (it does not move)?")
    while True:
        try:
            pouring.recover()
            break
        except DeviceError as reason:
            print(str(reason), file=sys.stderr)
            _confirm(operator, "Try again?")
    moves = pouring.plan_back_off()
    seconds = sum(move.trajectory.duration_s for move in moves)
    names = ", ".join(move.name for move in moves)
    _confirm(operator, f"Back off along the checked way ({names}; {seconds:.0f} s)?")
    pouring.back_off(moves)
    print("The arm is home. See that the cup stands at its station and is filled.")


def _keep_outcome(
    pipeline: Pipeline,
    operator: TerminalReporter | None,
    settings: CellSettings,
    folder: Path,
    cup: Cup,
) -> None:
    if settings.is_simulated:
        from app.outcome import simulated_outcome

        outcome = simulated_outcome(pipeline, settings, folder)
    elif operator is None:
        print(f"Count the spilled candies: poursight outcome {pipeline.session.path} --spilled N")
        return
    else:
        spilled = operator.ask_number("How many candies were spilled (empty: not counted)?")
        outcome = Outcome(cup.n_candies, spilled, operator.ask_text("Remarks?"), is_simulated=False, facts={})
    write_outcome(folder, outcome)
    print(outcome.sentence)
