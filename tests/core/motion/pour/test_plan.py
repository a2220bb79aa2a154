"""What holds on every sample of a plan, measured here once more and without the plan's own checks."""

from itertools import pairwise

import numpy as np
import pytest

from core.errors import SessionError
from core.geometry import transform_points
from core.imagination.cup import cup_pose, pivot_in_cup_m, pour_angle
from core.motion.joint_path import STEP_RAD
from core.motion.kinematics import flange_pose, singularity_measure, within_limits
from core.motion.pour.plan import MOVES, MovePhase, PourPlan, Segment
from core.motion.trajectory import SAMPLE_S
from tests.core.motion.pour.stage import POURING, Planned, planned, shipped_cell

CUP = POURING.cup


def held(pour: Planned, name: str) -> np.ndarray:
    """`T_base_cup` (N, 4, 4) at the samples of a move."""
    joints = pour.move(name).trajectory.joints_rad
    return flange_pose(pour.cell.arm, joints) @ pour.cell.T_flange_grasp @ pour.plan.T_grasp_cup


def tilt_rad(cups: np.ndarray) -> np.ndarray:
    return np.arccos(np.clip(cups[:, 2, 2], -1, 1))


def test_moves_are_named_and_join_each_other(pour: Planned):
    moves = pour.plan.moves
    facts = [(move.name, move.phase, move.holds_cup, move.gripper_after) for move in moves]
    assert facts == list(MOVES)
    for before, after in pairwise(moves):
        assert after.trajectory.start_rad == pytest.approx(before.trajectory.end_rad, abs=1e-9)
    assert pour.plan.start_rad == pytest.approx(pour.cell.home_rad)
    assert moves[-1].trajectory.end_rad == pytest.approx(pour.cell.home_rad)
    assert pour.plan.duration_s == pytest.approx(sum(move.trajectory.duration_s for move in moves))


def test_samples_are_near_to_each_other_in_time_joints_and_space(pour: Planned):
    corners = np.array([(x, y, z) for x in (-0.03, 0.03) for y in (-0.03, 0.03) for z in (0.0, CUP.length_m)])
    for move in pour.plan.moves:
        joints = move.trajectory.joints_rad
        assert np.diff(move.trajectory.times_s) == pytest.approx(SAMPLE_S)
        assert np.abs(np.diff(joints, axis=0)).max() <= STEP_RAD
        cups = flange_pose(pour.cell.arm, joints) @ pour.cell.T_flange_grasp @ pour.plan.T_grasp_cup
        places = np.array([transform_points(cup, corners) for cup in cups])
        assert np.linalg.norm(np.diff(places, axis=0), axis=-1).max() <= 0.005
        assert within_limits(pour.cell.arm, joints).all()


def test_speeds_and_accelerations_stay_within_the_limits(pour: Planned):
    limits = pour.cell.limits
    for move in pour.plan.moves:
        joints = move.trajectory.joints_rad
        at_rest = np.concatenate([joints[:1], joints, joints[-1:]])
        speed = np.abs(np.diff(joints, axis=0)).max() / SAMPLE_S
        acceleration = np.abs(np.diff(at_rest, n=2, axis=0)).max() / SAMPLE_S**2
        if move.name in ("pour", "turn back"):
            assert speed <= limits.pour_joint_speed_rad_s
            assert acceleration <= limits.pour_acceleration_rad_s2
            continue
        tool = (flange_pose(pour.cell.arm, joints) @ pour.cell.T_flange_grasp)[:, :3, 3]
        assert speed <= limits.joint_speed_rad_s
        assert acceleration <= limits.joint_acceleration_rad_s2
        assert np.linalg.norm(np.diff(tool, axis=0), axis=1).max() / SAMPLE_S <= limits.tool_speed_m_s


def test_cup_is_taken_where_it_stands_and_lifted_straight(pour: Planned):
    station, limits = pour.cell.cup_station_m, pour.cell.limits
    lift = held(pour, "lift")
    assert lift[0, :3, 3] == pytest.approx(station, abs=1e-6)
    assert lift[:, :2, 3] == pytest.approx(np.tile(station[:2], (len(lift), 1)), abs=1e-6)
    assert lift[-1, 2, 3] - station[2] == pytest.approx(limits.lift_m, abs=1e-6)
    assert held(pour, "put down")[-1, :3, 3] == pytest.approx(station, abs=1e-6)


@pytest.mark.parametrize("name", ["lift", "carry", "carry back", "put down"])
def test_full_cup_is_carried_level(pour: Planned, name: str):
    assert tilt_rad(held(pour, name)).max() <= pour.cell.limits.max_tilt_rad


def test_cup_tilts_more_and_more_until_it_is_ready(pour: Planned):
    tilt = tilt_rad(held(pour, "lay"))
    assert (np.diff(tilt) > -1e-6).all()
    assert tilt[-1] == pytest.approx(np.pi / 2 - CUP.slant_rad, abs=1e-6)
    ready = cup_pose(CUP, pour.target.pivot_m, pour.target.theta_rad, 0.0)
    lower = held(pour, "lower")
    assert lower[-1] == pytest.approx(ready, abs=1e-6)
    assert lower[:, :3, :3] == pytest.approx(np.tile(ready[:3, :3], (len(lower), 1, 1)), abs=1e-6)
    assert (np.diff(lower[:, 2, 3]) < 1e-9).all()


@pytest.mark.parametrize("name", ["pour", "turn back"])
def test_pivot_stays(pour: Planned, name: str):
    cups = held(pour, name)
    pivots = cups[:, :3, :3] @ pivot_in_cup_m(CUP) + cups[:, :3, 3]
    error = np.linalg.norm(pivots - pour.target.pivot_m, axis=1).max()
    assert error <= 0.0005
    assert error <= pour.plan.pivot_error_m + 1e-12


def test_pour_rotation_is_the_imagined_one_and_never_faster(pour: Planned):
    ready = cup_pose(CUP, pour.target.pivot_m, pour.target.theta_rad, 0.0)
    tilt = tilt_rad(held(pour, "pour"))
    gamma = tilt - tilt_rad(ready[None])[0]
    times = pour.move("pour").trajectory.times_s
    imagined = np.array([pour_angle(POURING, time)[0] for time in times])
    assert gamma[0] == pytest.approx(0, abs=1e-6)
    assert gamma[-1] == pytest.approx(POURING.gamma_0_rad, abs=1e-6)
    assert (gamma <= imagined + 1e-5).all()
    rate = np.diff(gamma) / SAMPLE_S
    share = np.clip(gamma[:-1] / POURING.gamma_0_rad, 0, 1)
    top = np.pi / 2 / POURING.turn_s * POURING.gamma_0_rad * np.sqrt(1 - share**2)
    assert (rate <= top + 0.002).all()
    assert pour.plan.imagined_turn_s == POURING.turn_s
    assert POURING.turn_s <= pour.plan.turn_s <= 1.05 * POURING.turn_s
    last = cup_pose(CUP, pour.target.pivot_m, pour.target.theta_rad, POURING.gamma_0_rad)
    assert held(pour, "pour")[-1] == pytest.approx(last, abs=1e-6)
    assert times[-1] >= POURING.settle_s + POURING.turn_s + POURING.wait_s


def test_segments_back_are_the_segments_out_reversed(pour: Planned):
    for out, back in [
        ("to the cup", "home"),
        ("grasp", "retreat"),
        ("lift", "put down"),
        ("carry", "carry back"),
        ("lay", "stand up"),
        ("lower", "raise"),
    ]:
        there, here = pour.move(out).trajectory, pour.move(back).trajectory
        assert np.array_equal(there.joints_rad[::-1], here.joints_rad)
    rotation = pour.move("turn back").trajectory.joints_rad[::-1]
    pouring = np.unique(pour.move("pour").trajectory.joints_rad, axis=0)
    assert np.array_equal(np.unique(rotation, axis=0), pouring)


def test_cup_in_the_hand_never_comes_near_a_singular_configuration(pour: Planned):
    measures = [
        singularity_measure(pour.cell.arm, move.trajectory.joints_rad).min()
        for move in pour.plan.moves
        if move.holds_cup
    ]
    assert min(measures) == pytest.approx(pour.plan.singularity)
    assert min(measures) >= pour.cell.limits.min_singularity


def test_figures_keep_the_limits(pour: Planned):
    limits = pour.cell.limits
    assert pour.plan.clearance_m >= limits.min_clearance_m
    assert pour.plan.cup_clearance_m >= limits.cup_clearance_m
    assert all(pour.plan.nearest)


def test_same_again(mug: Planned):
    again = planned("mug", 0, 1)
    assert again.plan.digest == mug.plan.digest


@pytest.mark.parametrize("share", [1.0, 0.01, 1e-5])
def test_begins_where_the_arm_is(share: float):
    start = shipped_cell().home_rad + share * np.array([0.3, -0.1, 0.1, 0.2, 0.0, 0.4])
    pour = planned("mug", 0, 1, start=start)
    assert np.array_equal(pour.plan.start_rad, start)
    assert np.array_equal(pour.plan.moves[-1].trajectory.end_rad, pour.cell.home_rad)
    pour.check()


def test_saves_and_loads(mug: Planned, tmp_path):
    mug.plan.save(tmp_path)
    loaded = PourPlan.load(tmp_path)
    assert loaded.digest == mug.plan.digest
    assert loaded.nearest == mug.plan.nearest
    assert [move.name for move in loaded.moves] == [move.name for move in mug.plan.moves]
    assert all(isinstance(move.name, Segment) for move in loaded.moves)
    assert {move.phase for move in loaded.moves} == set(MovePhase)
    mug.check(loaded)


def test_changed_plan_is_not_loaded(mug: Planned, tmp_path):
    mug.plan.save(tmp_path)
    path = tmp_path / "plan.json"
    path.write_text(path.read_text().replace('"turn_s": ', '"turn_s": 1'))
    with pytest.raises(SessionError, match="was changed after it was written"):
        PourPlan.load(tmp_path)
