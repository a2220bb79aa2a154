"""The candies of a pour at each moment: as imagined, or as the simulated cell counted them. Knows no Qt."""

from __future__ import annotations

from bisect import bisect_right
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from app.gui.views.scene.shapes import Shape
from core.geometry import BoolArray, FloatArray, invert_pose, transform_points
from core.imagination.particle_shape import particle_extents_m
from core.imagination.recording import Recording
from core.imagination.rendering.replay import make_replay, poured_in
from core.imagination.rendering.shapes import candy_mesh
from core.imagination.rotations import multiply_quaternions, quaternion_of
from core.parameters.bodies import CupParameters
from core.pipeline.session_view import SessionView

TRUTH_FOLDER = "table"
"""In a run of the simulated cell: what became of its candies."""


@dataclass(frozen=True, eq=False)
class PouredCandies:
    """N candies at all times of a pour.

    Attributes:
        recording: of candies and cup, in the base frame; what is spilled lies on the ground.
        kept: (N,) which are in the object at the end.
        stays_in_cup: (N,) which never leave the cup.
        shape: of a candy.
        settle_s: the recording's time at which the cup begins to rotate.
        turn_s: how long it rotates there.
        is_true: whether it is the outcome of a run, and not what was imagined of it.
    """

    recording: Recording
    kept: BoolArray
    stays_in_cup: BoolArray
    shape: Shape
    settle_s: float
    turn_s: float
    is_true: bool

    @property
    def duration_s(self) -> float:
        """Time of the last moment."""
        return float(self.recording.time_s[-1])

    def at(self, time_s: float) -> tuple[FloatArray, FloatArray]:
        """Return positions (N, 3) and quaternions (N, 4) at a time of the recording."""
        k = self._moment(time_s)
        return self.recording.positions_m[k].astype(float), self.recording.quaternions[k].astype(float)

    def cup_pose(self, time_s: float) -> FloatArray:
        """Return the pose (4, 4) of the cup at a time of the recording."""
        pose: FloatArray = self.recording.T_world_body[self._moment(time_s)].astype(float)
        return pose

    def carried(self, until_turn_s: float, T_base_cup: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return the candies so long before the cup rotates, with the cup at a pose (4, 4)."""
        return self._with_cup(max(self.settle_s - until_turn_s, 0.0), T_base_cup)

    def after(self, time_s: float, T_base_cup: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return the candies after the rotation: what is still in the cup goes with it."""
        positions_m, quaternions = self.at(time_s)
        if self.stays_in_cup.any():
            with_cup = self._with_cup(self.duration_s, T_base_cup)
            positions_m[self.stays_in_cup] = with_cup[0][self.stays_in_cup]
            quaternions[self.stays_in_cup] = with_cup[1][self.stays_in_cup]
        return positions_m, quaternions

    def _with_cup(self, time_s: float, T_base_cup: FloatArray) -> tuple[FloatArray, FloatArray]:
        positions_m, quaternions = self.at(time_s)
        change = T_base_cup @ invert_pose(self.cup_pose(time_s))
        turned = multiply_quaternions(quaternion_of(change[:3, :3]), quaternions)
        return transform_points(change, positions_m), turned

    def _moment(self, time_s: float) -> int:
        return max(bisect_right(self.recording.time_s.tolist(), time_s + 1e-6) - 1, 0)


CandiesKey = tuple[Path, tuple[int, int] | None, Path | None, str | None]
"""Session, planned pour (i, j), run that was made, digest of the imagined pours."""


def load_imagined_or_true(key: CandiesKey) -> PouredCandies | None:
    """Read the candies of a planned pour, else of a run; none if there are none.

    Raises:
        SessionError: a file is damaged.
    """
    folder, plan, run, _digest = key
    if plan is not None:
        return load_imagined(folder, *plan)
    return None if run is None else load_truth(folder, run)


def load_imagined(folder: Path, i: int, j: int) -> PouredCandies | None:
    """Read a session's imagined pour; none if it holds none.

    Raises:
        SessionError: a file is damaged.
    """
    view = SessionView.of(folder)
    if view.grid is None or view.drop is None:
        return None
    parameters, recording, box_m = view.parameters_of("pouring"), view.grid.recordings[i][j], view.drop.aabb_m
    kept = poured_in(recording, box_m, parameters.pouring.counted)
    staying = _in_cup(recording, parameters.pouring.cup)
    candy, extents_m = candy_mesh(parameters.particle), particle_extents_m(parameters.particle)
    replay = make_replay(recording, kept | staying, float(box_m[0, 2]), extents_m)
    return PouredCandies(
        replay.recording,
        kept,
        staying,
        (candy.vertices_m, candy.faces),
        parameters.pouring.settle_s,
        parameters.pouring.turn_s,
        is_true=False,
    )


def load_truth(folder: Path, run: Path) -> PouredCandies | None:
    """Read what the simulated cell counted after a run; none if nothing was counted.

    Raises:
        SessionError: a file is damaged.
    """
    from hardware.simulation.pour_outcome.outcome import TableOutcome

    if not (run / TRUTH_FOLDER).is_dir():
        return None
    found, parameters = TableOutcome.load(run / TRUTH_FOLDER), SessionView.of(folder).parameters_of("pouring")
    candy = candy_mesh(parameters.particle)
    shape = candy.vertices_m, candy.faces
    return PouredCandies(found.recording, found.in_object, found.in_cup, shape, 0.0, 0.0, is_true=True)


def _in_cup(recording: Recording, cup: CupParameters) -> BoolArray:
    """(N,) which candies are in the cup at the end: within its length and its mouth's radius."""
    last = invert_pose(recording.T_world_body[-1].astype(float))
    with np.errstate(invalid="ignore"):
        inside = transform_points(last, recording.positions_m[-1].astype(float))
        away_m = np.linalg.norm(inside[:, :2], axis=1)
        found: BoolArray = (away_m < cup.mouth_radius_m) & (inside[:, 2] > 0) & (inside[:, 2] < cup.length_m)
    return found
