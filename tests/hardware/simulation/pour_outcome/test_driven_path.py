import numpy as np
import pytest

from core.errors import InputError
from core.geometry import make_pose, rotation_x, rotation_z
from core.motion.arm_models import UR5
from core.motion.kinematics import flange_pose
from hardware.simulation.pour_outcome.driven_path import DrivenPath, cup_motion, driven_path
from tests.hardware.simulation.pour_outcome.paths import path_of, straight

T_FLANGE_CUP = make_pose(rotation_x(np.pi / 2), (0.0, -0.1, 0.1))
JOINTS_RAD = np.linspace([3.9, -2.1, -0.6, -2.4, 2.2, -0.3], [3.3, -1.5, -1.0, -2.3, 1.9, 0.9], 20)


def quarter_turn() -> DrivenPath:
    """In two seconds 0.4 m along x and a quarter turn about z."""
    return DrivenPath(
        np.array([1.0, 3.0]), np.array([np.eye(4), make_pose(rotation_z(np.pi / 2), (0.4, 0, 0))])
    )


def test_the_cup_is_where_the_joints_take_it() -> None:
    path = driven_path(UR5, np.arange(20) * 0.1, JOINTS_RAD, T_FLANGE_CUP)
    for k in (0, 7, 19):
        assert np.allclose(path.T_base_cup[k], flange_pose(UR5, JOINTS_RAD[k]) @ T_FLANGE_CUP)
    assert path.duration_s == pytest.approx(1.9)


def test_a_state_read_twice_counts_once() -> None:
    times_s = np.repeat(np.arange(10) * 0.1, 2)
    path = driven_path(UR5, times_s, JOINTS_RAD, T_FLANGE_CUP)
    assert np.array_equal(path.times_s, np.arange(10) * 0.1)
    assert np.allclose(path.T_base_cup[3], flange_pose(UR5, JOINTS_RAD[6]) @ T_FLANGE_CUP)


def test_between_samples_it_moves_straight_and_turns_evenly() -> None:
    poses = quarter_turn().at(np.array([0.0, 1.5, 2.0, 9.0]))
    assert np.allclose(poses[:, 0, 3], [0.0, 0.1, 0.2, 0.4])
    assert np.allclose(poses[1, :3, :3], rotation_z(np.pi / 8))
    assert np.allclose(poses[3, :3, :3], rotation_z(np.pi / 2))


def test_velocities_take_each_step_to_the_next() -> None:
    motion = cup_motion(quarter_turn(), 100)
    assert len(motion.times_s) == 201
    assert np.allclose(motion.velocities_m_s[:-1], [0.2, 0, 0])
    assert np.allclose(motion.angular_velocities_rad_s[:-1], [0, 0, np.pi / 4])
    assert not motion.velocities_m_s[-1].any()
    assert not motion.angular_velocities_rad_s[-1].any()


def test_a_rate_that_does_not_fit_ends_where_the_path_ends() -> None:
    motion = cup_motion(quarter_turn(), 7)
    assert motion.times_s[-1] >= 3.0
    assert np.allclose(motion.T_base_cup[-1], quarter_turn().T_base_cup[-1])


def test_long_standing_still_is_left_out_at_the_ends_only() -> None:
    stay, there = make_pose(np.eye(3), (0, 0, 0.1)), np.array([0.2, 0, 0.1])
    noise = np.random.default_rng(0).normal(scale=2e-5, size=(3000, 3))
    poses = [stay] * 1000 + straight(stay, there, 1.0)
    poses += [poses[-1]] * 500 + straight(poses[-1], stay[:3, 3], 1.0) + [stay] * 1000
    poses = [make_pose(pose[:3, :3], pose[:3, 3] + shift) for pose, shift in zip(poses, noise, strict=False)]
    path = path_of(poses)
    shorter = path.trimmed()
    assert 6.0 < shorter.duration_s < 6.5
    assert shorter.times_s[0] == pytest.approx(8 - 0.2, abs=0.1)
    assert np.allclose(shorter.at(np.array([8.5])), path.at(np.array([8.5])))


def test_a_cup_that_never_moves_keeps_its_path() -> None:
    path = path_of([np.eye(4)] * 50)
    assert path.trimmed() is path


@pytest.mark.parametrize(
    ("times_s", "poses", "words"),
    [
        ([0.0], np.eye(4)[None], "at least two"),
        ([0.0, 1.0], np.eye(4)[None], "at least two"),
        ([0.0, 1.0, 0.5], np.tile(np.eye(4), (3, 1, 1)), "sample 2"),
        ([0.0, np.nan], np.tile(np.eye(4), (2, 1, 1)), "finite"),
        ([0.0, 1.0], np.tile(2 * np.eye(4), (2, 1, 1)), "no pose"),
    ],
)
def test_what_is_no_path_is_refused(times_s: list[float], poses: np.ndarray, words: str) -> None:
    with pytest.raises(InputError, match=words):
        DrivenPath(np.array(times_s), poses)
