"""An arm at which nobody is asked: a simulated one, or one whose motions were confirmed beforehand."""

from __future__ import annotations

from collections.abc import Sequence

from core.errors import PoursightError
from core.motion.pour.plan import PlannedMove, PourPlan
from core.session.cups import Cup
from hardware.interfaces import ReadyStep


class Unattended:
    """Answers for nobody: what is planned is made, and a stopped run has ended."""

    is_present = False

    def confirm_pour(self, plan: PourPlan, note: str, robot: str, cup: Cup) -> None:
        """Nobody is asked."""

    def confirm_move(self, move: PlannedMove) -> None:
        """Nobody is asked."""

    def confirm_step(self, step: ReadyStep, why: str) -> None:
        """Nobody is asked: an arm that is not ready is not used."""

    def confirm_recovery(self, error: PoursightError, is_repeated: bool) -> None:
        """Nobody is asked: a stopped run has ended."""

    def is_cup_in_hand(self, known: str) -> bool:  # noqa: ARG002
        """Nobody is asked: a closed gripper is left as it is."""
        return False

    def confirm_opening(self, gripper: str, known: str) -> None:
        """Nobody is asked: a closed gripper is left as it is."""

    def confirm_back_off(self, moves: Sequence[PlannedMove]) -> None:
        """Nobody is asked: a stopped run has ended."""

    def backed_off(self) -> None:
        """Never: a stopped run has ended."""
