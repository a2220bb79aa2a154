"""Where an arm can pour at all: a bowl in the middle of the platform; and where a taught cup stands."""

from dataclasses import replace

import numpy as np
import pytest

from core.errors import MotionError
from core.motion.kinematics import flange_pose, inverse_kinematics
from core.motion.pour.stand_in import BOWL_M, judge_reach
from core.motion.pour.teaching import taught_station_m
from core.progress import Reporter
from core.workers import RunHere
from tests.core.motion.pour.stage import POURING, shipped_cell

MIDDLE_M = (-0.06, -0.35, 0.08)


@pytest.fixture(scope="module")
def reach():
    return judge_reach(shipped_cell(), MIDDLE_M, POURING, RunHere(), Reporter())


def test_the_shipped_cell_pours_from_most_sides_and_says_why_not_from_the_others(reach):
    assert len(reach.pours) == 24
    assert reach.n_sides == 8
    assert 4 <= reach.n_reached < 8
    assert " would " in reach.reason
    low, high = reach.object_aabb_m
    assert high - low == pytest.approx(BOWL_M)
    assert (low + high)[:2] / 2 == pytest.approx(MIDDLE_M[:2])
    assert low[2] == pytest.approx(MIDDLE_M[2])


def test_the_pour_to_go_through_is_the_clearest_that_can_be_made(reach):
    target = reach.target("a name")
    chosen = next(pour for pour in reach.pours if (pour.i, pour.j) == (target.i, target.j))
    assert chosen.is_feasible
    assert chosen.clearance_m >= max(pour.clearance_m for pour in reach.pours) - 1e-4
    assert target.pivot_m == pytest.approx(reach.pivot_m[target.i, target.j])
    none = replace(reach, pours=tuple(replace(pour, is_feasible=False) for pour in reach.pours))
    assert none.target("a name") is None and none.n_reached == 0


def test_a_cup_that_is_too_far_away_is_refused():
    far = replace(shipped_cell(), cup_station_m=np.array([0.9, 0.9, 0.015]))
    with pytest.raises(MotionError, match="cannot reach the cup"):
        judge_reach(far, MIDDLE_M, POURING, RunHere(), Reporter())


def joints_at(cell, T_base_grasp):
    """The arm's joints with its tool frame at a pose."""
    found = inverse_kinematics(cell.arm, (T_base_grasp @ np.linalg.inv(cell.T_flange_grasp))[None])
    return found.joints_rad[found.found][0]


@pytest.mark.parametrize("lean_deg", [0.0, 3.0])
def test_a_station_is_taught_by_the_joints_even_if_the_hand_leans_a_little(lean_deg):
    cell = shipped_cell()
    station_m = np.array([-0.48, 0.08, 0.02])
    lean = np.radians(lean_deg)
    grasp = np.eye(4)
    grasp[:3, :3] = [[1, 0, 0], [0, np.cos(lean), -np.sin(lean)], [0, np.sin(lean), np.cos(lean)]]
    grasp[:3, 3] = station_m + np.array([0, 0, cell.grip_height_m])
    joints_rad = joints_at(cell, grasp)
    assert flange_pose(cell.arm, joints_rad) @ cell.T_flange_grasp == pytest.approx(grasp, abs=1e-6)
    taught_m = taught_station_m(cell.arm, joints_rad, cell.T_flange_grasp, cell.grip_height_m)
    assert taught_m == pytest.approx(station_m, abs=1e-6)


def test_a_hand_that_leans_is_not_a_station():
    cell = shipped_cell()
    with pytest.raises(MotionError, match="would lean by"):
        taught_station_m(cell.arm, cell.home_rad, cell.T_flange_grasp, cell.grip_height_m)
