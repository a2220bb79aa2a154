"""The cup of a cell: its size, its station, its mass, and whether the arm can take it and pour at all."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from app.operations.calibration import step_names
from app.operations.calibration.cell_file import write_cup
from app.operations.calibration.cup_entry import DIGITS, CupEntry, entry_of, reach_is_for, values_of
from app.operations.calibration.provenance import RESULT, new_run, now, versions, withdraw
from core.errors import InputError, MotionError, PoursightError
from core.files import write_json
from core.motion.pour.cell import PourCell
from core.motion.pour.stand_in import PourReach, judge_reach
from core.parameters.bodies import CupParameters
from core.parameters.imagination import PouringParameters
from core.progress import Reporter
from core.session import explained
from core.workers import RunHere
from hardware.cell import CellSettings, read_cell
from hardware.cell.own_arm import own_kinematics
from hardware.cell.scene import pour_cell


@dataclass(frozen=True)
class CupFound:
    """What came of it.

    Attributes:
        folder: with the record.
        sentence: from how many sides the arm can pour.
        reason: what is in the way from the others; empty if there are none.
    """

    folder: Path
    sentence: str
    reason: str


def enter_cup(cell_file: Path, entry: CupEntry, reporter: Reporter) -> CupFound:
    """See whether the arm can take a cup and pour with it, and put it into the cell's file; some seconds.

    Args:
        cell_file: of the cell.
        entry: the cup.
        reporter: may cancel before anything is written.

    Raises:
        InputError: the cell plays a recording, or a mass is impossible; the file stays as it was.
        MotionError: the arm cannot take the cup, or cannot pour from any side; the file stays as it was.
        SessionError: the disk refuses.
    """
    settings = read_cell(cell_file)
    if settings.robot.kind == "replay":
        raise InputError(f"The {settings.name} plays back a recorded scan; it has no cup.")
    if entry.cup_kg > entry.payload_kg:
        raise InputError(
            f"The full cup ({entry.cup_kg:g} kg) is a part of all that hangs at the flange "
            f"({entry.payload_kg:g} kg) and cannot weigh more; weigh both once more."
        )
    before, after = values_of(entry_of(settings)), values_of(entry)
    if settings.cup is None:
        before["cup"] = None
    entered = _with_entry(settings, entry)
    reach = reach_of(entered, reporter)
    if reach.n_reached == 0:
        raise MotionError(f"With its cup there the arm cannot pour from any side. {reach.reason}")
    said = _sentence(entered, reach)
    folder = new_run(cell_file, step_names.CUP)
    result = {
        "time": now(), "said": said, "others": reach.reason, "before": before, "after": after,
        "for": reach_is_for(entered),
        "versions": versions(),
    }  # fmt: skip
    with explained(folder):
        write_json(folder / RESULT, result)
    try:
        write_cup(cell_file, after)
    except PoursightError:
        withdraw(folder)
        raise
    return CupFound(folder, said, reach.reason)


def reach_of(settings: CellSettings, reporter: Reporter) -> PourReach:
    """Return which pours into a bowl in the middle of the platform a cell's arm can make with its cup.

    Raises:
        MotionError: it cannot take the cup.
    """
    pouring = PouringParameters(cup=settings.cup or CupParameters())
    return judge_reach(
        cell_with_own_arm(settings), settings.place.platform_center_m, pouring, RunHere(), reporter
    )


def cell_with_own_arm(settings: CellSettings) -> PourCell:
    """Return the cell as the planner sees it, with its arm's own kinematics where they can be read."""
    return replace(pour_cell(settings), arm=own_kinematics(settings).model)


def _with_entry(settings: CellSettings, entry: CupEntry) -> CellSettings:
    return settings.model_copy(
        update={
            "cup": entry.cup,
            "place": settings.place.model_copy(
                update={"cup_station_m": tuple(np.round(entry.station_m, DIGITS).tolist())}
            ),
            "gripper": settings.gripper.model_copy(
                update={"payload_kg": entry.payload_kg, "cup_kg": entry.cup_kg}
            ),
        }
    )


def _sentence(settings: CellSettings, reach: PourReach) -> str:
    cup, station = reach.pouring.cup, 1000 * np.array(settings.place.cup_station_m)
    return (
        f"the arm takes it, and pours from {reach.n_reached} of {reach.n_sides} sides; "
        f"{1000 * cup.length_m:.0f} mm long, {2000 * cup.mouth_radius_m:.0f} mm wide, at "
        f"({station[0]:.0f}, {station[1]:.0f}, {station[2]:.0f}) mm"
    )
