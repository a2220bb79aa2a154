"""The operator at a real arm, as the terminal knows one: who is shown, and asked, what."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from pathlib import Path

from app.cli.remedies import worded
from app.cli.terminal import TerminalReporter
from app.operations import pouring
from app.operations.unattended import Unattended
from core.errors import Cancelled, InputError, NotAdvised, PoursightError, Remedy
from core.imagination.amount.result import amount_text
from core.motion.pour.plan import PlannedMove, PourPlan
from core.session.cups import Cup
from core.session.pour_runs import Outcome
from hardware.interfaces import ReadyStep
from hardware.scanning.route import ScanRoute

MM = 1000.0


class PrintingOperator(Unattended):
    """Prints what happens and confirms everything (`--yes`): a stopped run ends the command."""

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

    def confirm_route(self, route: ScanRoute, robot: str) -> None:
        """Print the route."""
        print(f"The route of the {robot}: {route.sentence}")

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

    def __init__(self, session: Path, terminal: TerminalReporter, is_doubt_accepted: bool = False) -> None:
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

    def confirm_step(self, step: ReadyStep, why: str) -> None:
        """Say what is the case, and ask."""
        print(why, file=sys.stderr)
        self._confirm(f"Let the program {step.value}?")

    def confirm_route(self, route: ScanRoute, robot: str) -> None:
        """Print the route and ask."""
        super().confirm_route(route, robot)
        self._confirm(f"Let the {robot} go through these views?")

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

    def is_cup_in_hand(self, known: str) -> bool:
        """Say what is known, and ask."""
        print(f"The gripper is closed. {known}", file=sys.stderr)
        return self._answer("Is the cup in the hand, as that run held it (no: it is empty, or unclear)?")

    def confirm_opening(self, gripper: str, known: str) -> None:
        """Say what is known, and ask."""
        print(
            f"{known or f'The {gripper} is closed, and no run of this session left the arm here.'} The hand "
            "may hold something, perhaps the cup, perhaps full. The arm does not move now. Hold what is in "
            "the hand, or put something under it; afterwards put the cup, filled, on its station.",
            file=sys.stderr,
        )
        self._confirm("Somebody holds it, or the hand is empty: open the gripper?")

    def confirm_back_off(self, moves: Sequence[PlannedMove]) -> None:
        """Name the moves and ask."""
        seconds = sum(move.trajectory.duration_s for move in moves)
        names = ", ".join(move.label for move in moves)
        self._confirm(f"Back off along the checked path ({names}; {seconds:.0f} s)?")

    def confirm_move(self, move: PlannedMove) -> None:
        """Name the next move of a dry run, and ask."""
        self._confirm(f"Next: {move.label} ({move.trajectory.duration_s:.0f} s). Go on?")

    def backed_off(self) -> None:
        """Say what to see to."""
        print("The arm is home. Make sure that the cup is at its station and filled.")

    def counted(self, cup: Cup) -> Outcome | None:
        """Ask."""
        spilled = self._terminal.ask_number("How many candies were spilled (empty: not counted)?")
        remarks = self._terminal.ask_text("Remarks?")
        return Outcome(cup.n_candies, spilled, remarks, is_simulated=False, facts={})

    def _confirm(self, question: str) -> None:
        if not self._answer(question):
            raise Cancelled("Not confirmed; nothing moved.")

    def _answer(self, question: str) -> bool:
        if not sys.stdin.isatty():
            raise InputError("Nothing moves without a confirmation: run it on a terminal, or add --yes.")
        return self._terminal.ask(question)


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
