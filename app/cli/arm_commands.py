"""What the commands that pour do: plan, pour, choose, outcome; and those that try devices."""

from __future__ import annotations

import asyncio
import signal
import sys
from collections.abc import Coroutine, Sequence
from contextlib import suppress
from pathlib import Path
from typing import Any

from app.cli.parameters import NOTHING_CHOSEN
from app.cli.remedies import worded
from app.cli.terminal import TerminalReporter, working
from app.operations import pouring
from app.operations.choosing import choose_pour
from app.operations.doctor import examine
from app.operations.outcome import enter_outcome
from core.errors import Cancelled, InputError, NotAdvised, PoursightError, Remedy
from core.imagination.amount.result import amount_text
from core.motion.pour.plan import PlannedMove, PourPlan
from core.motion.pour.planning import plan_pour
from core.session import Session
from core.session.cups import Cup
from core.session.operator_choice import withdraw_operator_choice
from core.session.pour_runs import Outcome, note_emptied
from hardware.simulation.ur_controller.identity import CONTROL_PORT, identity
from hardware.simulation.ur_controller.server import ControllerServer, ControllerSettings

MM = 1000.0


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
        else TerminalOperator(session, is_doubt_accepted, terminal)
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


def serve_controller(address: str, model: str, version: str, speed_up: float, faults: Sequence[str]) -> None:
    """Serve as a simulated UR controller until Ctrl-C or SIGTERM.

    Raises:
        InputError: an unknown model, version or fault, or the address is taken.
    """
    request = ControllerSettings(identity(model, version), address, speed_up=speed_up, faults=faults)

    def listens(at: str) -> None:
        print(
            f"Simulated {model} with PolyScope {version} listens at {at}; faults and questions: port "
            f"{CONTROL_PORT}. Ctrl-C ends it.",
            flush=True,
        )

    asyncio.run(_until_stopped(ControllerServer(request).run(listens)))


class PrintingOperator:
    """Prints what happens and confirms everything (`--yes`): a stopped run ends the command."""

    is_present = False

    def __init__(self, session: Path, is_doubt_accepted: bool = False) -> None:
        self._session, self._is_doubt_accepted = session, is_doubt_accepted

    def prepared(self, prepared: pouring.PreparedPour) -> None:
        """Print which pour will be made."""
        print(prepared.sentence)
        if prepared.amount is not None:
            print(amount_text(prepared.amount))

    def confirm_doubtful(self, advice: str) -> None:
        """Print the advice; to ignore it has to be asked for."""
        if not self._is_doubt_accepted:
            raise NotAdvised(advice, Remedy.POUR_ANYWAY)
        print(advice)

    def confirm_pour(self, plan: PourPlan, note: str, robot: str, cup: Cup) -> None:  # noqa: ARG002
        """Print the plan."""
        print("\n".join(plan_lines(plan, note)))

    def confirm_recovery(self, error: PoursightError, is_repeated: bool) -> None:
        """Nobody is asked: a stopped run has ended."""

    def confirm_back_off(self, moves: Sequence[PlannedMove]) -> None:
        """Nobody is asked: a stopped run has ended."""

    def backed_off(self) -> None:
        """Never: a stopped run has ended."""

    def counted(self, cup: Cup) -> Outcome | None:  # noqa: ARG002
        """Say how to enter it later."""
        print(f"Count the spilled candies: poursight outcome {self._session} --spilled N")
        return None

    def poured(self, outcome: Outcome) -> None:
        """Print what became of the candies."""
        print(outcome.sentence)


class TerminalOperator(PrintingOperator):
    """Somebody at the terminal, who is asked."""

    is_present = True

    def __init__(self, session: Path, is_doubt_accepted: bool, terminal: TerminalReporter) -> None:
        super().__init__(session, is_doubt_accepted)
        self._terminal = terminal

    def confirm_doubtful(self, advice: str) -> None:
        """Print the advice, and ask unless it was said already that it is to be ignored."""
        print(advice)
        if not self._is_doubt_accepted:
            self._confirm("Pour all the same?")

    def confirm_pour(self, plan: PourPlan, note: str, robot: str, cup: Cup) -> None:
        """Print the plan and ask."""
        super().confirm_pour(plan, note, robot, cup)
        self._confirm(f"Let the {robot} pour{f' ({cup.words})' if cup.words else ''}?")

    def confirm_recovery(self, error: PoursightError, is_repeated: bool) -> None:
        """Say what stopped the arm, and ask."""
        self._terminal.forget_cancel()
        if is_repeated:
            print(worded(error), file=sys.stderr)
            self._confirm("Try again?")
            return
        print(
            "Stopped on request." if isinstance(error, Cancelled) else f"Stopped: {worded(error)}",
            file=sys.stderr,
        )
        self._confirm("Find and fix what stopped it. Then: make the arm ready again (it does not move)?")

    def confirm_back_off(self, moves: Sequence[PlannedMove]) -> None:
        """Name the moves and ask."""
        seconds = sum(move.trajectory.duration_s for move in moves)
        names = ", ".join(move.label for move in moves)
        self._confirm(f"Back off along the checked path ({names}; {seconds:.0f} s)?")

    def backed_off(self) -> None:
        """Say what to see to."""
        print("The arm is home. Make sure that the cup is at its station and filled.")

    def counted(self, cup: Cup) -> Outcome | None:
        """Ask."""
        spilled = self._terminal.ask_number("How many candies were spilled (empty: not counted)?")
        remarks = self._terminal.ask_text("Remarks?")
        return Outcome(cup.n_candies, spilled, remarks, is_simulated=False, facts={})

    def _confirm(self, question: str) -> None:
        if not sys.stdin.isatty():
            raise InputError("Nothing moves without a confirmation: run it on a terminal, or add --yes.")
        if not self._terminal.ask(question):
            raise Cancelled("Not confirmed; nothing moved.")


def plan_lines(plan: PourPlan, note: str = "") -> list[str]:
    """Return a plan for people: why it is this pour, its moves, their times, and its clearance."""
    lines = [note] if note else []
    lines.append(f"The plan, {plan.duration_s:.0f} s:")
    lines += [f"  {move.label:<14}{move.trajectory.duration_s:6.1f} s{_grip(move)}" for move in plan.moves]
    slower_s = plan.turn_s - plan.imagined_turn_s
    slower = f", {slower_s:.1f} s of it for speeding up" if slower_s > 0.05 else ""
    lines.append(f"The cup rotates for {plan.turn_s:.1f} s{slower} (imagined: {plan.imagined_turn_s:.1f} s).")
    lines.append(
        f"Clearance: {plan.clearance_m * MM:.0f} mm between {plan.nearest[0]} and {plan.nearest[1]}; "
        f"{plan.cup_clearance_m * MM:.0f} mm around the cup. The pivot stays within "
        f"{plan.pivot_error_m * MM:.3f} mm."
    )
    return lines


def _grip(move: PlannedMove) -> str:
    return "" if move.gripper_after is None else f", then {move.gripper_after} the gripper"


async def _until_stopped(serving: Coroutine[Any, Any, None]) -> None:
    """Run until it ends or a signal asks for the end."""
    task = asyncio.ensure_future(serving)
    for number in (signal.SIGINT, signal.SIGTERM):
        asyncio.get_running_loop().add_signal_handler(number, task.cancel)
    with suppress(asyncio.CancelledError):
        await task
