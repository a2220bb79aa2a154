"""The route of a real arm through the views of a scan: planned and timed as a whole before anything moves."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from core.errors import MotionError
from core.geometry import FloatArray
from core.motion.clearance import MotionScene
from core.motion.joint_path import RouteSettings, find_route
from core.motion.pour.tool_path import SpeedLimits, slow_joint_trajectory
from core.motion.trajectory import SAMPLE_S, JointTrajectory
from hardware.cell import Cell
from hardware.cell.settings import CellSettings
from hardware.scanning.views import PlannedView


@dataclass(frozen=True)
class Leg:
    """The way to one view.

    Attributes:
        view: where it ends.
        trajectory: of the joints; none if there is no clear way.
        problem: why there is none; empty if there is one.
    """

    view: PlannedView
    trajectory: JointTrajectory | None
    problem: str = ""


@dataclass(frozen=True)
class ScanRoute:
    """What the arm will do, to be shown before it is confirmed.

    Attributes:
        legs: in their order, each from where the one before ends.
        duration_s: of all motions, and of resting at each view.
        tool_speed_m_s: of the fastest point of arm and tools.
        purpose: the beginning of a sentence that says what for; empty for the scan's own views.
    """

    legs: tuple[Leg, ...]
    duration_s: float
    tool_speed_m_s: float
    purpose: str = ""

    @property
    def n_views(self) -> int:
        """To how many views there is a way."""
        return sum(leg.trajectory is not None for leg in self.legs)

    @property
    def sentence(self) -> str:
        """For people."""
        said = (
            f"{self.purpose}{self.n_views} views in about {self.duration_s:.0f} s, no part of the arm faster "
            f"than {self.tool_speed_m_s:.2f} m/s."
        )
        left_out = [leg.view.name for leg in self.legs if leg.trajectory is None]
        return said + (f" Without a clear way to {', '.join(left_out)}." if left_out else "")


def route_options(settings: CellSettings) -> RouteSettings:
    """How a way between two views is searched for."""
    return RouteSettings(min_clearance_m=settings.scan.min_clearance_m, via_rad=(settings.robot.home_rad,))


def plan_route(cell: Cell, start_rad: FloatArray, views: Sequence[PlannedView]) -> ScanRoute:
    """Plan the ways from a configuration (6,) through views; one without a clear way is passed over."""
    settings = cell.settings
    robot = settings.robot
    limits = SpeedLimits(
        robot.joint_speed_rad_s, robot.joint_acceleration_rad_s2, settings.motion.tool_speed_m_s
    )
    legs = []
    here_rad = start_rad
    for view in views:
        try:
            corners = find_route(cell.scene, here_rad, view.joints_rad, route_options(settings))
        except MotionError as error:
            legs.append(Leg(view, None, str(error)))
            continue
        legs.append(Leg(view, slow_joint_trajectory(cell.scene, corners, limits)))
        here_rad = np.array(view.joints_rad)
    driven = [leg.trajectory for leg in legs if leg.trajectory is not None]
    moving_s = sum(trajectory.duration_s for trajectory in driven)
    fastest_m_s = max((_fastest_m_s(cell.scene, trajectory) for trajectory in driven), default=0.0)
    return ScanRoute(tuple(legs), moving_s + len(driven) * settings.scan.settle_s, fastest_m_s)


def _fastest_m_s(scene: MotionScene, trajectory: JointTrajectory) -> float:
    """Speed of the fastest end of a capsule of arm and tools."""
    points_m = scene.capsule_ends(trajectory.joints_rad)
    return float(np.linalg.norm(np.diff(points_m, axis=0), axis=-1).max() / SAMPLE_S)
