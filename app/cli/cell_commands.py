"""What the commands do that set a cell up."""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np

from app.cli.operators import PrintingOperator, TerminalOperator
from app.cli.options import given_path
from app.cli.terminal import TerminalReporter
from app.operations.calibration import cell_file, hand_eye, steps
from app.operations.calibration import check as checking
from core.calibration.board import BoardSpec
from core.calibration.collecting import Look
from core.errors import Cancelled, InputError
from hardware.cell import read_cell

MM = 1000.0


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

        def taken(look: Look, n_usable: int) -> None:
            _print_look(look)
            terminal.progress("views", min(n_usable, n_views), n_views)

        found = hand_eye.calibrate_cell(path, terminal, operator, taken, n_views, is_restarted)
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

        def moved() -> None:
            if is_confirmed:
                return
            if not sys.stdin.isatty():
                raise InputError("Move the board, and run it on a terminal, or add --yes.")
            if not terminal.ask("Was the board moved and turned, so that the camera sees it from here?"):
                raise Cancelled("Not confirmed; nothing moved.")

        found = checking.check_cell(path, terminal, operator, moved, lambda look, _: _print_look(look))
    print(next(step.figure for step in steps.steps(path) if step.name == "check"))
    if not found.agreement.is_good:
        print("The calibration does not hold: calibrate anew, and see that camera and board are fixed.")
    return found.agreement.is_good


def undo_board(name: str) -> None:
    """Forget the last entry."""
    before = steps.undo_board(_path(name))
    print("No board is entered." if before is None else f"The board of {before.time} counts again.")


def undo_calibration(name: str) -> None:
    """Put back what was there before."""
    path = _path(name)
    hand_eye.undo_calibration(path)
    print(f"The hand-eye pose in {path} is as it was before the calibration.")


def undo_check(name: str) -> None:
    """Let the last check count no more."""
    checking.undo_check(_path(name))
    print("The last check counts no more.")


def show(name: str) -> None:
    """List the steps."""
    path = _path(name)
    settings = read_cell(path)
    print(f"{settings.name}{' (SIMULATED)' if settings.is_simulated else ''}: {path}")
    for step in steps.steps(path):
        print(f"{step.name:<10}{step.state.value:<8}{step.time:<27}{step.figure}")


def _path(name: str) -> Path:
    return cell_file.cell_path(str(given_path(name)))


def _print_look(look: Look) -> None:
    if look.problem:
        print(f"Not used: {look.problem}", file=sys.stderr)
