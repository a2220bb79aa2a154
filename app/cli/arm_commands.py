"""What the commands that pour do: plan, pour, choose, outcome; and those that try devices."""

from __future__ import annotations

import asyncio
import signal
from collections.abc import Coroutine, Sequence
from contextlib import suppress
from pathlib import Path
from typing import Any

from app.cli.operators import PrintingOperator, TerminalOperator, plan_lines
from app.cli.parameters import NOTHING_CHOSEN
from app.cli.terminal import TerminalReporter, working
from app.library.places import cup_runs_folder
from app.operations import pouring
from app.operations.choosing import choose_pour
from app.operations.doctor import examine
from app.operations.outcome import enter_outcome
from core.formats import excerpt
from core.imagination.kept_runs import KeptRuns
from core.motion.pour.planning import plan_pour
from core.session import Session, explained
from core.session.operator_choice import withdraw_operator_choice
from core.session.pour_runs import note_emptied
from hardware.grippers.robotiq_line import ROBOTIQ_PORT
from hardware.simulation.ur_controller.identity import CONTROL_PORT, identity
from hardware.simulation.ur_controller.server import ControllerServer
from hardware.simulation.ur_controller.settings import ControllerSettings


def plan(session: Path, cell_file: Path | None, workers: int | None) -> None:
    """Say which pours the arm can make, and what the chosen one looks like from home."""
    with working(session, NOTHING_CHOSEN, workers, is_existing=True) as pipeline:
        prepared = pouring.prepare(pipeline, pouring.cell_of(pipeline.session, cell_file))
        target = prepared.chosen()
        found = plan_pour(prepared.cell, target, prepared.cell.home_rad)
    print(prepared.sentence)
    print("\n".join(plan_lines(found, target.note)))


def pour(
    session: Path,
    cell_file: Path | None,
    is_confirmed: bool,
    is_doubt_accepted: bool,
    is_emptied: bool,
    workers: int | None,
) -> None:
    """Pour, after a confirmation; into an object that was emptied the first cup again."""
    terminal = TerminalReporter()
    operator = (
        PrintingOperator(session, is_doubt_accepted)
        if is_confirmed
        else TerminalOperator(session, terminal, is_doubt_accepted)
    )
    with working(session, NOTHING_CHOSEN, workers, is_existing=True, terminal=terminal) as pipeline:
        if is_emptied:
            note_emptied(pipeline.session.path)
        folder = pouring.pour(pipeline, pouring.cell_of(pipeline.session, cell_file), operator)
    print(f"The run is in {folder}.")


def choose(session: Path, i: int, j: int, reason: str) -> None:
    """Choose pour (i, j) from now on."""
    made = choose_pour(Session.open(session), i, j, reason)
    print(
        f"Pour {made.i}, {made.j} is chosen ({made.reason}). 'poursight plan {session}' says whether the arm "
        "can make it."
    )


def withdraw(session: Path) -> None:
    """Let the program choose again."""
    withdraw_operator_choice(Session.open(session).path)
    print("The program chooses again.")


def outcome(session: Path, spilled: int | None, remarks: str) -> None:
    """Enter what was spilled in the newest pour."""
    with Session.open(session) as held:
        print(enter_outcome(held.path, spilled, remarks).sentence)


def doctor(cell_file: Path | None) -> bool:
    """Print what was found of this installation and of a cell; return whether nothing is in the way."""
    is_fine = True
    for finding in examine(cell_file):
        mark = "ok  " if finding.problem is None else "BAD "
        print(f"{mark}{finding.subject:<22}{finding.value}")
        if finding.problem is not None:
            print(f"    -> {finding.problem}")
            is_fine = False
    return is_fine


def clear_cache() -> None:
    """Remove what was computed of the cup for all sessions; it is computed again when it is needed."""
    kept = KeptRuns(cup_runs_folder())
    with explained(kept.folder):
        kept.empty()


def serve_controller(
    address: str, model: str, version: str, speed_up: float, faults: Sequence[str], robotiq: str | None
) -> None:
    """Serve as a simulated UR controller until Ctrl-C or SIGTERM.

    Raises:
        InputError: an unknown model, version or fault, or the address is taken.
    """
    # What is refused is quoted: of a word that is no name at all the beginning will do.
    model, version, address, *faults = map(excerpt, (model, version, address, *faults))
    request = ControllerSettings(
        identity(model, version), address, speed_up=speed_up, faults=faults, robotiq=robotiq
    )

    beside = "" if robotiq is None else f" A Robotiq {robotiq} answers at port {ROBOTIQ_PORT}."

    def listens(at: str) -> None:
        print(
            f"Simulated {model} with PolyScope {version} listens at {at}; faults and questions: port "
            f"{CONTROL_PORT}.{beside} Ctrl-C ends it.",
            flush=True,
        )

    asyncio.run(_until_stopped(ControllerServer(request).run(listens)))


async def _until_stopped(serving: Coroutine[Any, Any, None]) -> None:
    """Run until it ends or a signal asks for the end."""
    task = asyncio.ensure_future(serving)
    for number in (signal.SIGINT, signal.SIGTERM):
        asyncio.get_running_loop().add_signal_handler(number, task.cancel)
    with suppress(asyncio.CancelledError):
        await task
