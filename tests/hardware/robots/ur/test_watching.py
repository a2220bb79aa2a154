"""What is watched beside the moves themselves: an arm at rest, and the margin that a plan leaves."""

from __future__ import annotations

import time

import numpy as np
import pytest

from core.motion.arm_models import UR5
from core.motion.margin import PathMargin
from core.motion.trajectory import JointTrajectory
from hardware.errors import ProgramStopped, RobotError, TrackingLost
from tests.awake import within
from tests.hardware.robots.ur.bench import FAR, HOME, T_FLANGE_TOOL, Bench, may_change_threads
from tests.patience import HANG_S, wait_until

pytestmark = [pytest.mark.system, pytest.mark.punctual]

STOPPED_WITHIN_S = 0.3


def margin(allowed_m: float) -> PathMargin:
    """Of the tool."""
    levers_m = np.array([1.0, 0.9, 0.6, 0.3, 0.3, 0.2])
    return PathMargin(UR5, np.array([6]), T_FLANGE_TOOL[None, :3, 3], levers_m, allowed_m)


def long_way(here: np.ndarray) -> JointTrajectory:
    times_s = np.arange(0, 2.2, 0.008)
    share = (1 - np.cos(np.pi * times_s / times_s[-1])) / 2
    return JointTrajectory(times_s, here + np.outer(share, FAR - HOME))


@pytest.mark.parametrize("is_calm", [False, True], ids=["just stopped", "stood long"])
@pytest.mark.parametrize("fault", ["foreign moving", "foreign gap moving"])
def test_an_arm_at_rest_that_another_program_moves_is_stopped(
    bench: Bench, fault: str, is_calm: bool
) -> None:
    if is_calm and may_change_threads():
        wait_until(bench.is_calm)
    before = bench.joints()
    with within(STOPPED_WITHIN_S):
        bench.controller.command(fault)
        wait_until(lambda: bench.robot.stopped_by() is not None)
        wait_until(lambda: bench.truth()["runtime_state"] == "STOPPED" and not bench.is_moving())
    assert np.abs(bench.joints() - before).max() < 0.05
    assert bench.stays_where_it_is(0.5)
    with pytest.raises(RobotError, match="recover"):
        bench.robot.follow(long_way(bench.joints()))
    bench.works_again()


@pytest.mark.parametrize("way", ["joint move", "path"])
def test_an_arm_that_is_pushed_at_the_moment_it_arrives_is_stopped(bench: Bench, way: str) -> None:
    robot, here = bench.robot, bench.joints()
    move = robot.move_joints([here, here - 0.05], 1.0, 4.0) if way == "joint move" else None
    (move or robot.follow(long_way(here))).wait(HANG_S)
    bench.controller.command("jump 1 0.03")
    wait_until(lambda: robot.stopped_by() is not None)
    assert isinstance(robot.stopped_by(), TrackingLost)
    bench.works_again()


def test_a_program_that_ends_while_the_arm_rests_is_not_taken_for_ours(bench: Bench) -> None:
    bench.controller.command("foreign gap still")
    wait_until(lambda: bench.robot.stopped_by() is not None)
    assert isinstance(bench.robot.stopped_by(), ProgramStopped)
    wait_until(lambda: bench.truth()["runtime_state"] == "STOPPED")
    bench.works_again()


def test_resting_stops_nothing(bench: Bench) -> None:
    time.sleep(1.0)
    assert bench.robot.stopped_by() is None
    bench.robot.move_joints([HOME, HOME - 0.05], 1.0, 4.0).wait(HANG_S)
    time.sleep(0.3)
    assert bench.robot.stopped_by() is None


@pytest.mark.parametrize("angle_rad", [0.03, -0.03, 0.012])
def test_a_jump_beyond_the_plans_margin_is_noticed(bench: Bench, angle_rad: float) -> None:
    move = bench.robot.follow(long_way(bench.joints()), margin(0.004))
    wait_until(lambda: np.abs(bench.truth()["speeds_rad_s"]).max() > 0.5)
    with within(STOPPED_WITHIN_S):
        bench.controller.command(f"jump 2 {angle_rad}")
        with pytest.raises(TrackingLost, match=r"mm beside its path, where its clearance leaves 4\.0 mm"):
            move.wait(HANG_S)
        wait_until(lambda: not bench.is_moving())
    bench.works_again()


@pytest.mark.parametrize("under_way_rad_s", [0.15, 0.8])
def test_a_program_that_stands_is_noticed_early_in_a_move_too(
    either_bench: Bench, under_way_rad_s: float
) -> None:
    move = either_bench.robot.follow(long_way(either_bench.joints()), margin(0.004))
    wait_until(lambda: np.abs(either_bench.truth()["speeds_rad_s"]).max() > under_way_rad_s)
    with within(STOPPED_WITHIN_S):
        either_bench.controller.command("foreign still")
        with pytest.raises(TrackingLost):
            move.wait(HANG_S)
    wait_until(lambda: either_bench.truth()["runtime_state"] == "STOPPED", 1)
    either_bench.works_again()


@pytest.mark.parametrize("latency", ["latency 5 5", "latency 40 30", "latency 70 20"])
def test_a_late_arm_is_not_taken_for_one_that_stands(bench: Bench, latency: str) -> None:
    bench.robot.follow(long_way(bench.joints()), margin(0.01)).wait(20)  # a quick link's lag is known then
    bench.controller.command(latency)
    bench.robot.follow(long_way(HOME).reversed()).wait(HANG_S)
    bench.robot.follow(long_way(bench.joints())).wait(HANG_S)


def test_a_plan_with_little_margin_is_followed_to_its_end(either_bench: Bench) -> None:
    either_bench.robot.follow(long_way(either_bench.joints()), margin(0.001)).wait(HANG_S)


def test_a_program_that_moves_nearly_along_the_path_is_noticed_by_the_margin(bench: Bench) -> None:
    bench.robot.follow(long_way(bench.joints()), margin(0.004)).wait(20)  # its usual lag is known then
    bench.robot.move_joints([bench.joints(), HOME], 3.0, 10.0).wait(HANG_S)
    move = bench.robot.follow(long_way(bench.joints()), margin(0.004))
    wait_until(lambda: np.abs(bench.truth()["speeds_rad_s"]).max() > 0.5)
    with within(STOPPED_WITHIN_S):
        bench.controller.command("foreign moving")
        with pytest.raises(RobotError):
            move.wait(HANG_S)
    wait_until(lambda: not bench.is_moving(), 1)
    bench.works_again()
