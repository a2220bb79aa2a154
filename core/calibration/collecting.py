"""Collecting the views of a calibration: what is known after each round, and where to look next.

The first guess of the hand-eye pose is rough, so the first rounds are short, and keep the board far from the
image's edge: what they see, even a part of the board, tells where it is for the next ones.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace

from core.calibration.board import BoardSpec
from core.calibration.hand_eye import calibrate_hand_eye, guessed_rig
from core.calibration.proposing import (
    USUAL_VIEWS,
    Proposal,
    ProposalTask,
    in_short_order,
    propose_poses,
)
from core.calibration.rig import Rig
from core.calibration.view_set import FEWEST_VIEWS, why_too_little
from core.calibration.views import BoardView
from core.errors import StageError
from core.geometry import FloatArray
from core.motion.clearance import MotionScene
from core.scan.model import Intrinsics

_ROUNDS = ((3, 90.0), (5, 50.0))
"""How many poses the first rounds have, and how many px from where it is expected the board may show up."""
_SURE_PX = 20.0
MOST_ROUNDS = 8


@dataclass(frozen=True)
class Look:
    """What became of one look at the board.

    Attributes:
        joints_rad: (6,) where the arm was.
        view: what was seen, if anything.
        problem: why it is not used; empty if it is.
    """

    joints_rad: FloatArray
    view: BoardView | None
    problem: str = ""

    @property
    def is_used(self) -> bool:
        """Whether the fit uses it."""
        return self.view is not None and not self.problem


@dataclass
class Collection:
    """The looks taken so far, and what is to be known to choose the next.

    Attributes:
        scene: the arm and what it must not touch.
        board: as printed.
        intrinsics: of the camera.
        image_size_px: width and height.
        T_flange_camera: (4, 4) the first guess.
        home_rad: (6,) of the arm.
        min_range_m: of the camera.
        n_wanted: how many views are wanted.
        looks: in the order in which they were taken.
    """

    scene: MotionScene
    board: BoardSpec
    intrinsics: Intrinsics
    image_size_px: tuple[int, int]
    T_flange_camera: FloatArray
    home_rad: FloatArray
    min_range_m: float = 0.35
    n_wanted: int = USUAL_VIEWS
    looks: list[Look] = field(default_factory=list)

    @property
    def views(self) -> tuple[BoardView, ...]:
        """The usable views."""
        return tuple(look.view for look in self.looks if look.view is not None and look.is_used)

    def next_poses(self, here_rad: FloatArray, n_round: int) -> tuple[Proposal, ...]:
        """Choose where to look in a round, in a short order; none when there are enough views.

        Args:
            here_rad: (6,) where the arm is.
            n_round: the round, from 0.

        Raises:
            StageError: nothing of the board was seen yet.
        """
        n_missing = self.n_wanted - len(self.views)
        if n_missing <= 0 or n_round >= MOST_ROUNDS:
            return ()
        n, aim_error_px = _ROUNDS[n_round] if n_round < len(_ROUNDS) else (n_missing, _SURE_PX)
        task = ProposalTask(
            self.known_rig(), self.board, self.image_size_px, self.home_rad, aim_error_px, self.min_range_m
        )
        tried = [look.joints_rad for look in self.looks]
        proposed = propose_poses(self.scene, task, min(n, n_missing), self.views, tried)
        if not proposed and aim_error_px > _SURE_PX:
            task = replace(task, aim_error_px=_SURE_PX)
            proposed = propose_poses(self.scene, task, min(n, n_missing), self.views, tried)
        return in_short_order(proposed, here_rad)

    def known_rig(self) -> Rig:
        """Return what is known by now: the fit, if there are views for one, or a guess.

        Raises:
            StageError: nothing of the board was seen yet.
        """
        views = self.views
        if len(views) >= FEWEST_VIEWS and why_too_little(views, self.T_flange_camera) is None:
            return calibrate_hand_eye(views, self.board, self.intrinsics).rig
        seen = [look.view for look in self.looks if look.view is not None]
        if not seen:
            raise StageError(
                "The camera has not seen the board yet; guide the arm by hand to where it sees all of it."
            )
        return guessed_rig(self.T_flange_camera, seen, self.board, self.intrinsics)
