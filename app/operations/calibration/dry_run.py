"""A dry run: the whole pour with an empty cup, slowly, each move confirmed, before anything is scanned.

Everything is what a pour has: plan, checks, driver, watch, log, and the way back after a stop.
"""

from __future__ import annotations

from collections.abc import Callable
from contextlib import AbstractContextManager, nullcontext
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Protocol

from app.operations.arm import connected
from app.operations.calibration import step_names
from app.operations.calibration.cup_entry import reach_is_for
from app.operations.calibration.provenance import (
    RESULT,
    calibration_folder,
    latest_result,
    new_run,
    now,
    versions,
)
from app.operations.pouring import CupOperator, empty_hand, pour_cup
from app.operations.unattended import Unattended
from core.errors import InputError, MotionError
from core.files import make_folder, write_json
from core.motion.pour.cell import PourCell
from core.motion.pour.plan import PlannedMove, PourPlan
from core.motion.pour.stand_in import judge_reach
from core.parameters.bodies import CupParameters
from core.parameters.imagination import PouringParameters
from core.progress import Reporter
from core.session import explained
from core.session.cups import Cup
from core.workers import RunHere
from hardware.cell import Arm, CellSettings, open_arm, read_cell
from hardware.cell.scene import pour_cell
from hardware.pouring.pouring import PLAN_FOLDER, Pouring
from hardware.pouring.procedure import no_question

SHARE = 0.3
"""Of all speeds, the pour rotation's among them."""
_EMPTY_CUP = Cup(number=1, n_cups=1, n_candies=0, before=None)
_DIGEST = "dry run"
_SPEEDS = ("joint_speed_rad_s", "tool_speed_m_s", "pour_joint_speed_rad_s")


class DryRunOperator(CupOperator, Protocol):
    """The person at the arm that goes through the pour."""

    def confirm_move(self, move: PlannedMove) -> None:
        """Whether the next move shall be made; the arm is at rest until then."""
        ...


@dataclass(frozen=True)
class DryRun:
    """A dry run that came to its end.

    Attributes:
        folder: with the record.
        run: with plan, states and events.
        sentence: how long it took, and how close it came to anything.
    """

    folder: Path
    run: Path
    sentence: str


def dry_run(
    cell_file: Path,
    reporter: Reporter,
    operator: DryRunOperator | None,
    opened: Callable[[Arm], AbstractContextManager[object]] = nullcontext,
) -> DryRun:
    """Let the arm take an empty cup, pour nothing into a bowl that is not there, and put the cup back.

    What an earlier dry run left in the hand is brought back first.

    Args:
        cell_file: of the cell, whose cup was entered.
        reporter: may cancel; the arm comes to rest.
        operator: confirms every move of a real arm; a simulated one asks nobody.
        opened: called with the arm; what it returns is entered while it is connected.

    Raises:
        InputError: the cup was not entered, or a real arm has no operator.
        MotionError: there is no pour that the arm can make.
        DeviceError: the arm was stopped, and nobody could make it ready again.
        Cancelled: somebody said no; the arm is at rest.
    """
    settings = read_cell(cell_file)
    _refuse_unentered(cell_file, settings)
    if settings.robot.is_real and operator is None:
        raise InputError("A real arm goes through a dry run only with somebody who confirms it.")
    person: DryRunOperator = operator if operator is not None and settings.robot.is_real else Unattended()
    root = calibration_folder(cell_file) / step_names.DRY_RUN
    with explained(cell_file.parent):
        make_folder(root)
    with connected(open_arm(settings), person, reporter) as arm, opened(arm):
        pouring = _pouring(arm, root, reporter, person)
        if arm.gripper.is_closed and person.is_present:
            empty_hand(pouring, person)
        run = pour_cup(pouring, person, arm.robot.name, _EMPTY_CUP)
    said = _sentence(PourPlan.load(run / PLAN_FOLDER))
    folder = new_run(cell_file, step_names.DRY_RUN)
    result = {"time": now(), "said": said, "run": run.name, "for": reach_is_for(settings)}
    with explained(folder):
        write_json(folder / RESULT, result | {"versions": versions()})
    return DryRun(folder, run, said)


def slowed(cell: PourCell) -> PourCell:
    """Return a cell whose arm moves at a share of its speeds."""
    slower = {name: SHARE * getattr(cell.limits, name) for name in _SPEEDS}
    return replace(cell, limits=cell.limits.model_copy(update=slower))


def slow_pouring(settings: CellSettings) -> PouringParameters:
    """Return a pour of the cell's cup whose rotation takes as much longer."""
    usual = PouringParameters(cup=settings.cup or CupParameters())
    return usual.model_copy(update={"turn_s": usual.turn_s / SHARE})


def _refuse_unentered(cell_file: Path, settings: CellSettings) -> None:
    latest = latest_result(cell_file, step_names.CUP)
    if latest is None or settings.cup is None:
        raise InputError(
            f"No cup was entered for {cell_file}, so the arm would not know where to take one; enter it "
            "first."
        )


def _pouring(arm: Arm, root: Path, reporter: Reporter, person: DryRunOperator) -> Pouring:
    settings = arm.settings
    cell = slowed(replace(pour_cell(settings), arm=arm.robot.kinematics.model))
    middle_m = settings.place.platform_center_m
    reach = judge_reach(cell, middle_m, slow_pouring(settings), RunHere(), reporter)
    target = reach.target(_DIGEST)
    if target is None:
        raise MotionError(f"The arm cannot pour from any side. {reach.reason}")
    confirm_move = person.confirm_move if person.is_present else no_question
    return Pouring(arm, cell, target, root, reporter, confirm_move)


def _sentence(plan: PourPlan) -> str:
    return (
        f"{len(plan.moves)} moves in {plan.duration_s:.0f} s, at {SHARE:.0%} of the speed; "
        f"{1000 * plan.clearance_m:.0f} mm clear of everything ({plan.nearest[0]} and {plan.nearest[1]}), "
        f"the cup {1000 * plan.cup_clearance_m:.0f} mm"
    )
