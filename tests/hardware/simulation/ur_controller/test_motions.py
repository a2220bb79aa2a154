"""Trajectories and followed targets, checked against the arm's kinematics."""

from __future__ import annotations

import numpy as np
import pytest

from core.geometry import FloatArray, invert_pose
from core.motion.arm_models import UR5
from core.motion.kinematics import flange_pose
from hardware.robots.joint_motion import Trapezoid
from hardware.robots.ur.pose_vectors import (
    pose_from_vector,
    rotation_from_vector,
    vector_from_pose,
    vector_from_rotation,
)
from hardware.simulation.ur_controller.arm import Arm
from hardware.simulation.ur_controller.identity import HOME_RAD
from hardware.simulation.ur_controller.motions import Braking, NoSolution, StraightLine
from hardware.simulation.ur_controller.path_script import PathMove, injected_moves, plan_path

HOME = np.array(HOME_RAD)
TIMES_PER_S = 500


def sampled(trajectory: object, duration_s: float) -> tuple[FloatArray, FloatArray]:
    samples = [trajectory.at(t) for t in np.arange(0, duration_s, 1 / TIMES_PER_S)]  # type: ignore[attr-defined]
    return np.array([joints for joints, _, _ in samples]), np.array([speeds for _, speeds, _ in samples])


@pytest.mark.parametrize("angle", [0.0, 1e-9, 0.5, 3.0, np.pi - 1e-7, np.pi])
def test_a_pose_vector_survives_the_way_to_a_pose_and_back(angle: float) -> None:
    for axis in np.array([[1, 0, 0], [0, 1, 0], [0, 0, 1], [1, -2, 3], [-3, 1, -1]]):
        rotation = rotation_from_vector(angle * axis / np.linalg.norm(axis))
        again = rotation_from_vector(vector_from_rotation(rotation))
        np.testing.assert_allclose(again, rotation, atol=1e-9)
    vector = np.array([0.1, -0.2, 0.3, 0.4, -0.5, 0.6])
    np.testing.assert_allclose(vector_from_pose(pose_from_vector(list(vector))), vector, atol=1e-12)


def test_braking_takes_the_time_and_the_way_of_its_deceleration() -> None:
    speeds = np.array([1.0, -2.0, 0, 0, 0, 0.5])
    braking = Braking(HOME, speeds, 10.0)
    assert braking.duration_s == pytest.approx(0.2)
    np.testing.assert_allclose(braking.end_rad - HOME, speeds * 0.1)
    np.testing.assert_allclose(braking.at(0.1)[1], speeds / 2)


def test_a_straight_line_is_straight_and_as_fast_as_told() -> None:
    T_end = flange_pose(UR5, HOME).copy()
    T_end[:3, 3] += [0.05, -0.1, -0.15]
    line = StraightLine(UR5, HOME, T_end, 0.25, 1.2)
    joints, _ = sampled(line, line.duration_s)
    places = flange_pose(UR5, joints)[:, :3, 3]
    direction = T_end[:3, 3] - places[0]
    length = float(np.linalg.norm(direction))
    off = np.cross(places - places[0], direction / length)
    assert np.linalg.norm(off, axis=1).max() < 1e-5
    assert line.duration_s == pytest.approx(Trapezoid(length, 0.25, 1.2).duration_s)
    speed = np.linalg.norm(np.diff(places, axis=0), axis=1) * TIMES_PER_S
    assert speed.max() == pytest.approx(0.25, rel=0.01)
    np.testing.assert_allclose(flange_pose(UR5, line.end_rad), T_end, atol=1e-9)


def test_a_line_out_of_reach_has_no_solution() -> None:
    T_end = flange_pose(UR5, HOME).copy()
    T_end[:3, 3] += [2, 0, 0]
    with pytest.raises(NoSolution):
        StraightLine(UR5, HOME, T_end, 0.25, 1.2)


def corner_path(blend_m: float) -> list[PathMove]:
    ends = HOME + np.array([[0.4, 0, 0, 0, 0, 0], [0.4, 0.4, 0, 0, 0, 0]])
    return [PathMove(True, tuple(end), False, 1.0, 3.0, r) for end, r in zip(ends, [blend_m, 0], strict=True)]


@pytest.mark.parametrize("blend_m", [0.02, 0.08])
def test_a_blend_passes_the_corner_within_its_radius_without_standing(blend_m: float) -> None:
    moves = corner_path(blend_m)
    trajectory = plan_path(UR5, np.eye(4), moves, HOME)
    joints, speeds = sampled(trajectory, trajectory.duration_s)
    corner = flange_pose(UR5, np.array(moves[0].target))[:3, 3]
    away = np.linalg.norm(flange_pose(UR5, joints)[:, :3, 3] - corner, axis=1)
    inside = away < blend_m
    assert 0 < away.min() < blend_m, "the corner is cut, not reached and not missed"
    assert np.abs(speeds[inside]).max(axis=1).min() > 0.1
    steps = np.abs(np.diff(speeds, axis=0)).max() * TIMES_PER_S
    assert steps <= 3.0 * 1.01, "no joint speeds up or slows down harder than told"
    np.testing.assert_allclose(joints[-1], moves[-1].target, atol=1e-4)


def test_without_a_blend_the_arm_stands_at_the_corner() -> None:
    trajectory = plan_path(UR5, np.eye(4), corner_path(0.0), HOME)
    _, speeds = sampled(trajectory, trajectory.duration_s)
    middle = slice(int(0.25 * len(speeds)), int(0.75 * len(speeds)))
    assert np.abs(speeds[middle]).max(axis=1).min() < 0.02
    each_s = Trapezoid(0.4, 1.0, 3.0).duration_s
    assert trajectory.duration_s == pytest.approx(2 * each_s)
    assert plan_path(UR5, np.eye(4), corner_path(0.08), HOME).duration_s < 2 * each_s - 0.1


def test_injected_moves_are_read() -> None:
    script = (
        "def rtde_control():\n    def exec_move_path():\n        # inject move path\n"
        "\tmovej([0,1e-1,2,3,4,5],a=3,v=1,r=0.02)\n\tsignal_async_progress(1)\n"
        "\tmovel(p[0.1,0.2,0.3,0,0,-1],a=1.2,v=0.25,r=0)\n    end\n    movej([9,9,9,9,9,9])\nend\n"
    )
    first, second = injected_moves(script)
    assert first == PathMove(True, (0, 0.1, 2, 3, 4, 5), False, 1.0, 3.0, 0.02)
    assert second == PathMove(False, (0.1, 0.2, 0.3, 0, 0, -1), True, 0.25, 1.2, 0.0)


def test_a_tool_moves_with_the_flange() -> None:
    arm = Arm(UR5, HOME)
    arm.T_flange_tcp = pose_from_vector([0, 0, 0.1, 0.3, 0, 0])
    speeds = np.array([0.3, -0.2, 0.1, 0.4, -0.5, 0.6])
    step_s = 1e-6
    before, after = (flange_pose(UR5, HOME + sign * speeds * step_s) @ arm.T_flange_tcp for sign in (-1, 1))
    moved = (after[:3, 3] - before[:3, 3]) / (2 * step_s)
    turned = vector_from_rotation(after[:3, :3] @ before[:3, :3].T) / (2 * step_s)
    np.testing.assert_allclose(arm.tcp_speed(HOME, speeds), [*moved, *turned], atol=1e-5)
    T_tool = pose_from_vector(list(arm.tcp_pose(HOME)))
    np.testing.assert_allclose(T_tool @ invert_pose(arm.T_flange_tcp), flange_pose(UR5, HOME), atol=1e-9)
