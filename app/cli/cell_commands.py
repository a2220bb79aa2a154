"""What the commands do that set a cell up."""

from __future__ import annotations

import sys
from functools import partial
from pathlib import Path

import numpy as np

from app.cli.operators import PrintingOperator, TerminalOperator
from app.cli.options import given_path
from app.cli.terminal import TerminalReporter
from app.operations.calibration import cell_file, hand_eye, step_names, steps, undoing
from app.operations.calibration import check as checking
from app.operations.calibration import devices as devices_of_cell
from app.operations.calibration import reference as referring
from app.operations.calibration import table as measuring
from app.operations.calibration import touch as touching
from app.operations.calibration import views as choosing_views
from app.operations.calibration.capture import CaptureObserver
from app.operations.calibration.crop import enter_crop_box
from core.calibration.board import BoardSpec
from core.calibration.collecting import Look
from core.calibration.touching import MOST_OFF_M
from core.errors import Cancelled, InputError
from hardware.cell import CellSettings, read_cell

MM = 1000.0
_UNDONE = {
    step_names.BOARD: "The board that was entered last is forgotten; see: poursight cell show {file}",
    step_names.HAND_EYE: "The hand-eye pose in {file} is as it was before the calibration.",
    step_names.CHECK: "The last check counts no more.",
    step_names.TABLE: "Platform, crop box and table in {file} are where they were before.",
    step_names.VIEWS: "The views in {file} are those from before.",
    step_names.CUP: "The cup in {file} is the one from before.",
    step_names.DRY_RUN: "The last dry run counts no more.",
    step_names.REFERENCE: "The reference view is removed; scans begin without it.",
}


def new(name: str, is_simulated: bool, seed: int, address: str | None) -> None:
    """Write a cell's file."""
    path = cell_file.new_cell(name, is_simulated, seed, address)
    print(f"{path}\nNext: poursight cell board {path.stem}")


def board(
    name: str,
    paper: str,
    squares: tuple[int, int],
    square_mm: float,
    dictionary: str,
    measured_mm: float | None,
) -> None:
    """Print a board, or enter its measured size."""
    path = _path(name)
    wanted = BoardSpec(squares[0], squares[1], square_mm / MM, dictionary)
    pdf = steps.enter_board(path, wanted, paper, None if measured_mm is None else measured_mm / MM)
    if measured_mm is None:
        print(
            f"{pdf}\nPrint it at 100 %, glue it onto something stiff, and measure a whole row of "
            "squares. Next: "
            f"poursight cell board {name} --measured-mm SIDE"
        )
    else:
        print(f"Squares of {measured_mm:g} mm are entered. Next: poursight cell calibrate {name}")


def calibrate(name: str, n_views: int, is_restarted: bool, is_confirmed: bool) -> None:
    """Calibrate, and say what it is worth."""
    path = _path(name)
    with TerminalReporter() as terminal:
        operator = PrintingOperator(path.parent) if is_confirmed else TerminalOperator(path.parent, terminal)

        def taken(look: Look, n_usable: int, _: object) -> None:
            _print_look(look)
            terminal.progress("views", min(n_usable, n_views), n_views)

        observer = CaptureObserver(taken=taken)
        found = hand_eye.calibrate_cell(path, terminal, operator, observer, n_views, is_restarted)
    stated, unseen = found.bounds, found.held_out
    print(
        f"Calibrated from {found.n_views} views ({found.n_refused} looks refused); views and result: "
        f"{found.folder}\n"
        f"  with 95 %: {stated.pouring_m * MM:.2f} mm at the place of pouring; the camera to "
        f"{stated.position_m * MM:.2f} mm and {np.degrees(stated.angle_rad):.3f} degrees\n"
        f"  views that the fit did not see: {unseen.position_m * MM:.2f} mm, {unseen.rms_px:.2f} px, "
        f"{unseen.ratio:.1f} times what is expected\n"
        "  "
        f"{found.diversity}\n"
        f"  the camera hangs {found.moved_m * MM:.1f} mm and {np.degrees(found.moved_rad):.1f} "
        "degrees beside "
        f"where the file had it; the file is changed.\n"
        f"Next: poursight cell check {name}"
    )


def check(name: str, is_confirmed: bool) -> bool:
    """Check, and return whether the calibration holds."""
    path = _path(name)
    with TerminalReporter() as terminal:
        operator = PrintingOperator(path.parent) if is_confirmed else TerminalOperator(path.parent, terminal)

        moved = partial(
            _ask_for_board,
            terminal,
            is_confirmed,
            "Was the board moved and turned, so that the camera sees it?",
        )
        found = checking.check_cell(path, terminal, operator, moved, _PRINTING)
    print(_figure(path, step_names.CHECK))
    if not found.agreement.is_good:
        print("The calibration does not hold: calibrate anew, and see that camera and board are fixed.")
    else:
        print(
            f"Next: poursight cell touch {name} (the board still lies there), or poursight cell table {name}"
        )
    return found.agreement.is_good


def touch(name: str, tip_mm: tuple[float, float, float] | None) -> bool:
    """Read a touched corner, and return whether the calibration holds."""
    found = touching.read_touch(_path(name), None if tip_mm is None else np.array(tip_mm) / MM)
    x, y, z = found.touch.off_m * MM
    distance_mm, number = found.touch.distance_m * MM, found.touch.corner + 1
    print(
        f"The tip is {distance_mm:.1f} mm beside where the camera has corner {number} of the board: "
        f"({x:+.1f}, {y:+.1f}, {z:+.1f}) mm along the axes of the arm's base.\n"
        f"With 95 % the calibration is off by at most {found.expected_m * MM:.1f} mm; what the arm and the "
        "tip's measures are off comes on top."
    )
    if not found.touch.is_good:
        print(
            f"More than {MOST_OFF_M * MM:g} mm: see that the tip is measured right and the board was not "
            "moved, and touch the corner again; if it stays so, calibrate anew."
        )
    return found.touch.is_good


def devices(name: str) -> bool:
    """Try arm and camera, and return whether both can be used."""
    path = _path(name)
    problems = []
    for step in (step_names.ARM, step_names.CAMERA):
        finding = devices_of_cell.examine_device(path, step)
        print(f"{step:<10}{finding.value}")
        if finding.problem is not None:
            problems.append(finding.problem)
            print(f"          {finding.problem}", file=sys.stderr)
    if not problems:
        print(f"Next: poursight cell board {name}")
    return not problems


def table(name: str, thickness_mm: float, is_confirmed: bool) -> None:
    """Measure where platform and table are, and say what changed."""
    path = _path(name)
    with TerminalReporter() as terminal:
        operator = PrintingOperator(path.parent) if is_confirmed else TerminalOperator(path.parent, terminal)
        laid = partial(
            _ask_for_board, terminal, is_confirmed, "Does the board lie flat on the middle of the platform?"
        )
        found = measuring.measure_table(path, terminal, operator, laid, thickness_mm / MM, _PRINTING)
    x, y, z = found.moved_m * MM
    print(
        f"{_figure(path, step_names.TABLE)}.\n"
        f"That is ({x:+.1f}, {y:+.1f}, {z:+.1f}) mm beside where the file had it; platform, crop box and "
        "table are moved there.\n"
        f"Next: poursight cell views {name}"
    )


def views(name: str, n_views: int) -> None:
    """Choose views, and say what they are like."""
    path = _path(name)
    with TerminalReporter() as terminal:
        print(choosing_views.choose_views(path, terminal, n_views).sentence)
    print(f"Next: poursight cell cup {name}")


def crop(name: str, from_mm: tuple[float, float, float], to_mm: tuple[float, float, float]) -> None:
    """Enter a crop box."""
    path = _path(name)
    enter_crop_box(path, np.array(from_mm) / MM, np.array(to_mm) / MM)
    print(f"The crop box in {path} is changed.\nNext: poursight cell views {name}")


def reference(name: str, is_confirmed: bool) -> None:
    """Store one look, and say what it is for."""
    path = _path(name)
    with TerminalReporter() as terminal:
        operator = PrintingOperator(path.parent) if is_confirmed else TerminalOperator(path.parent, terminal)
        laid = partial(_ask_for_board, terminal, is_confirmed, "Is the board fixed where it can stay?")
        referring.store_reference(path, terminal, operator, laid, _PRINTING)
    print(f"Stored: {_figure(path, step_names.REFERENCE)}.")


def undo(name: str, step: str) -> None:
    """Take back what a step did last."""
    path = _path(name)
    undoing.undo(path, step)
    print(_UNDONE[step].format(file=path))


def show(name: str) -> None:
    """List the steps."""
    path = _path(name)
    settings = read_cell(path)
    print(f"{settings.name}{' (SIMULATED)' if settings.is_simulated else ''}: {path}")
    for step in steps.steps(path):
        print(f"{step.name:<10}{step.state.value:<8}{step.time:<27}{step.figure}")


def cell_of_name(name: str) -> tuple[Path, CellSettings]:
    """Return a cell's file, and what it says."""
    path = _path(name)
    return path, read_cell(path)


def _path(name: str) -> Path:
    return cell_file.cell_path(str(given_path(name)))


def _figure(path: Path, name: str) -> str:
    return next(step.figure for step in steps.steps(path) if step.name == name)


def _ask_for_board(terminal: TerminalReporter, is_confirmed: bool, question: str) -> None:
    """Ask whether somebody laid the board where it is wanted."""
    if is_confirmed:
        return
    if not sys.stdin.isatty():
        raise InputError("Lay the board where it is wanted, and run it on a terminal, or add --yes.")
    if not terminal.ask(question):
        raise Cancelled("Not confirmed; nothing moved.")


def _print_look(look: Look) -> None:
    if look.problem:
        print(f"Not used: {look.problem}", file=sys.stderr)


_PRINTING = CaptureObserver(taken=lambda look, *_: _print_look(look))
