"""The controller's behaviour cycle by cycle, without sockets and without waiting."""

from __future__ import annotations

import time

import numpy as np
import pytest

from core.errors import InputError
from hardware.modes import RobotMode, SafetyMode
from hardware.robots.joint_motion import Trapezoid
from hardware.simulation.ur_controller.controller import RuntimeState
from hardware.simulation.ur_controller.identity import HOME_RAD, identity
from hardware.simulation.ur_controller.rtde_protocol import OUTPUT_TYPES, layout
from hardware.simulation.ur_controller.rtde_server import Outputs
from tests.hardware.simulation.ur_controller.desk import DONE, SCRIPT, Desk

HOME = np.array(HOME_RAD)
X, Z = np.eye(6)[0], np.eye(6)[2]
TARGET = HOME + 0.8 * X
MOVE_J, MOVE_L, SPEED_J, SERVO_J, SERVO_STOP, STOP_L, STOP_J, WATCHDOG = 1, 3, 9, 11, 16, 33, 34, 35
RUNNING = 0x8000
MOVE_S = Trapezoid(0.8, 1.0, 2.0).duration_s

both = pytest.mark.parametrize("version", ["3.15", "5.11"])


def progress(desk: Desk) -> int:
    return desk.controller.registers.ints[2]


def start_moving(version: str = "3.15") -> Desk:
    desk = Desk(version)
    desk.do(MOVE_J, [*TARGET, 1.0, 2.0], is_async=True)
    desk.run(0.6)
    assert desk.controller.arm.is_moving
    return desk


@both
def test_a_joint_move_takes_the_time_of_its_trapezoid(version: str) -> None:
    desk = Desk(version)
    time_s = desk.do(MOVE_J, [*TARGET, 1.0, 2.0])
    assert time_s == pytest.approx(MOVE_S, abs=3 * desk.controller.dt_s)
    np.testing.assert_array_equal(desk.controller.arm.joints_rad, TARGET)


def test_joint_speeds_stay_within_the_arm_whatever_is_asked() -> None:
    desk = Desk()
    time_s = desk.do(MOVE_J, [*(HOME + 3.0 * X), 100.0, 40.0])
    assert time_s > 3.0 / np.pi


@both
def test_an_asynchronous_move_is_done_at_once_and_tells_when_it_ends(version: str) -> None:
    desk = Desk(version)
    assert desk.do(MOVE_J, [*TARGET, 1.0, 2.0], is_async=True) < 0.02
    first = progress(desk)
    assert first & RUNNING and first >> 24 == 1
    desk.run_until(lambda: not progress(desk) & RUNNING)
    np.testing.assert_array_equal(desk.controller.arm.joints_rad, TARGET)
    assert desk.controller.arm.is_idle
    desk.do(MOVE_J, [*HOME, 1.0, 2.0], is_async=True)
    assert progress(desk) >> 24 == 2, "each operation has a number"


def test_stopping_takes_as_long_as_its_deceleration() -> None:
    desk = start_moving()
    speed = desk.controller.arm.speeds_rad_s[0]
    assert desk.do(STOP_J, [8.0]) == pytest.approx(speed / 8.0, abs=0.03)
    assert not desk.controller.arm.is_moving and not progress(desk) & RUNNING
    assert 0 < desk.controller.arm.joints_rad[0] < 0.8


def test_a_new_move_on_the_way_brakes_first_and_then_goes() -> None:
    desk = start_moving()
    desk.do(MOVE_J, [*HOME, 1.0, 2.0])
    np.testing.assert_array_equal(desk.controller.arm.joints_rad, HOME)


def test_a_line_moves_the_tool() -> None:
    desk = Desk()
    arm = desk.controller.arm
    desk.do(29, [0, 0, 0.1, 0, 0, 0])
    target = arm.tcp_pose(arm.joints_rad) - 0.1 * Z
    time_s = desk.do(MOVE_L, [*target, 0.25, 1.2])
    np.testing.assert_allclose(arm.tcp_pose(arm.joints_rad), target, atol=1e-8)
    assert time_s == pytest.approx(Trapezoid(0.1, 0.25, 1.2).duration_s, abs=0.03)


def test_the_slider_stretches_a_move() -> None:
    desk = Desk()
    desk.controller.arm.slider = 0.5
    desk.run(0.5)
    assert desk.do(MOVE_J, [*TARGET, 1.0, 2.0]) == pytest.approx(2 * MOVE_S, rel=0.02)


@both
def test_servoing_follows_late_by_the_look_ahead_time(version: str) -> None:
    desk = Desk(version)
    speed_rad_s, lookahead_s = 0.4, 0.1
    target = HOME.copy()
    for _ in range(round(1.0 / desk.controller.dt_s)):
        target = target + speed_rad_s * desk.controller.dt_s * X
        desk.write(SERVO_J, [*target, 0, 0, desk.controller.dt_s, lookahead_s, 300])
        desk.controller.step()
    lag = target - desk.controller.arm.joints_rad
    assert lag[0] == pytest.approx(speed_rad_s * lookahead_s, rel=0.15)
    desk.run(1.0)
    np.testing.assert_allclose(desk.controller.arm.joints_rad, target, atol=1e-4)


def test_servoing_never_overshoots_and_keeps_the_limits() -> None:
    desk = Desk()
    desk.write(SERVO_J, [*(HOME + 2.0 * X), 0, 0, 0.008, 0.03, 2000])
    seen = []
    for _ in range(250):
        desk.controller.step()
        seen.append(desk.controller.arm.target_rad[0])
    speeds = np.diff(seen) / 0.008
    assert max(seen) <= 2.0 + 1e-3
    assert speeds.max() <= np.pi + 1e-9
    assert np.abs(np.diff(speeds)).max() <= 40 * 0.008 + 1e-9


def test_a_speed_holds_until_it_is_stopped() -> None:
    desk = Desk()
    desk.write(SPEED_J, [0.5, 0, 0, 0, 0, 0, 2.0, 0.1])
    desk.run(1.0)
    assert desk.controller.arm.speeds_rad_s[0] == pytest.approx(0.5)
    desk.clear()
    desk.do(15, [5.0])
    assert not desk.controller.arm.is_moving


def test_a_pause_holds_on_the_path_and_play_goes_on_with_the_move() -> None:
    desk = start_moving()
    assert desk.controller.pause()
    assert desk.run_until(lambda: desk.controller.runtime_state is RuntimeState.PAUSED) < 0.3
    held = desk.controller.arm.joints_rad.copy()
    desk.run(1.0)
    np.testing.assert_array_equal(desk.controller.arm.joints_rad, held)
    assert progress(desk) & RUNNING, "nobody tells the client"
    assert desk.controller.play()
    desk.run(2.0)
    np.testing.assert_array_equal(desk.controller.arm.joints_rad, TARGET)


def test_a_protective_stop_brakes_holds_and_unlocks_after_five_seconds() -> None:
    desk = start_moving()
    desk.controller.protective_stop()
    assert desk.run_until(lambda: not desk.controller.arm.is_moving) < 0.3
    held = desk.controller.arm.joints_rad.copy()
    assert not desk.controller.unlock_protective_stop()
    assert not desk.controller.play(), "not while it is locked"
    desk.run(5.0)
    assert desk.controller.unlock_protective_stop()
    desk.run(0.5)
    np.testing.assert_array_equal(desk.controller.arm.joints_rad, held)
    assert desk.controller.play(), "the danger: the old move goes on"
    desk.run(2.0)
    np.testing.assert_array_equal(desk.controller.arm.joints_rad, TARGET)


def test_stop_before_unlock_takes_the_old_move_away() -> None:
    desk = start_moving()
    desk.controller.protective_stop()
    desk.run(5.1)
    assert desk.controller.stop() and desk.controller.unlock_protective_stop()
    held = desk.controller.arm.joints_rad.copy()
    assert not desk.controller.play()
    desk.run(1.0)
    np.testing.assert_array_equal(desk.controller.arm.joints_rad, held)


def test_an_emergency_stop_takes_the_power_and_the_program() -> None:
    desk = start_moving()
    c = desk.controller
    c.emergency_stop()
    before = c.arm.joints_rad.copy()
    assert desk.run_until(lambda: c.robot_mode is RobotMode.POWER_OFF) < 0.3
    assert c.arm.joints_rad[0] > before[0], "it brakes, it does not freeze"
    assert c.runtime_state is RuntimeState.STOPPED
    c.power_on()
    assert c.robot_mode is RobotMode.POWER_OFF, "not while the button is in"
    c.release_emergency_stop()
    c.power_on()
    c.upload(SCRIPT)
    assert c.runtime_state is RuntimeState.STOPPED, "no program without power"
    desk.run(1.1)
    assert c.robot_mode is RobotMode.IDLE
    c.release_brakes()
    desk.run(1.1)
    assert c.robot_mode is RobotMode.RUNNING and c.safety_mode is SafetyMode.NORMAL
    c.upload(SCRIPT)
    assert c.runtime_state is RuntimeState.PLAYING


def test_releasing_the_brakes_switches_the_power_on_first() -> None:
    desk = Desk()
    desk.controller.power_off()
    desk.run(0.1)
    desk.controller.release_brakes()
    assert desk.run_until(lambda: desk.controller.robot_mode is RobotMode.RUNNING) == pytest.approx(
        2, abs=0.1
    )


def test_a_stuck_joint_stays_behind_and_leaps_nowhere_when_freed() -> None:
    desk = Desk()
    desk.controller.arm.stuck.add(0)
    desk.do(MOVE_J, [*TARGET, 1.0, 2.0])
    where = [HOME[0], *TARGET[1:]]
    np.testing.assert_array_equal(desk.controller.arm.joints_rad, where)
    desk.controller.arm.stuck.clear()
    desk.run(1.0)
    np.testing.assert_array_equal(desk.controller.arm.joints_rad, where)
    np.testing.assert_array_equal(desk.controller.arm.target_rad, where)


def test_a_starved_watchdog_ends_the_program() -> None:
    desk = start_moving()
    desk.do(WATCHDOG, [50.0])
    desk.controller.step()
    assert desk.controller.runtime_state is RuntimeState.PLAYING
    time.sleep(0.05)
    desk.controller.step()
    assert desk.controller.runtime_state is RuntimeState.STOPPING


def test_inverse_kinematics_without_a_solution_ends_the_program() -> None:
    desk = Desk()
    desk.write(46, [3, 0, 0, 0, 0, 0])
    desk.run(0.1)
    assert desk.controller.runtime_state is RuntimeState.STOPPED and desk.answer != DONE


def test_kinematics_agree_with_each_other() -> None:
    desk = Desk("5.11", "UR5e")
    registers = desk.controller.registers
    desk.do(43)
    pose = registers.doubles[:6]
    desk.do(30, [*pose, *(HOME + 0.01)])
    np.testing.assert_allclose(registers.doubles[:6], HOME, atol=1e-6)
    desk.do(39, [*pose, 0, 0, 0, 0, 0, 0])
    np.testing.assert_allclose(registers.doubles[:6], pose, atol=1e-9)
    for code, arguments, answer in [(37, [7.0, 0, 0, 0, 0, 0], 0), (37, HOME, 1), (60, pose, 1), (47, [], 1)]:
        desk.do(code, arguments)
        assert registers.ints[1] == answer


@pytest.mark.parametrize("refusal", ["local", "ignores", "off"])
def test_scripts_are_not_taken_when_they_cannot_be(refusal: str) -> None:
    desk = Desk()
    c = desk.controller
    c.stop()
    desk.run(0.1)
    if refusal == "local":
        c.is_remote = False
    elif refusal == "ignores":
        c.ignores_uploads = True
    else:
        c.power_off()
    c.upload(SCRIPT)
    desk.run(0.1)
    assert c.runtime_state is RuntimeState.STOPPED


def test_outputs_fit_their_types_and_tell_the_truth() -> None:
    desk = start_moving()
    desk.do(29, [0, 0, 0.1, 0, 0, 0])
    values = Outputs(desk.controller).refresh(OUTPUT_TYPES)
    for name, kind in OUTPUT_TYPES.items():
        layout([kind]).pack(*values[name])
    arm = desk.controller.arm
    np.testing.assert_allclose(values["actual_TCP_pose"], arm.tcp_pose(arm.joints_rad))
    np.testing.assert_allclose(values["tcp_offset"], [0, 0, 0.1, 0, 0, 0], atol=1e-12)
    assert values["robot_status_bits"] == (3,) and values["safety_status_bits"] == (1,)
    desk.controller.protective_stop()
    desk.run(0.5)
    values = Outputs(desk.controller).refresh(["actual_TCP_speed"])
    assert values["safety_status_bits"][0] & 1 << 2 and values["robot_status_bits"] == (1,)
    assert values["actual_TCP_speed"] == (0.0,) * 6 and values["runtime_state"] == (4,)


def test_memory_stays_bounded() -> None:
    desk = Desk()
    for k in range(5000):
        desk.controller.journal.note("something", number=k)
    assert len(desk.controller.journal.newest(10**6)) == 2000


@pytest.mark.parametrize(("model", "version"), [("UR10", "3.15"), ("UR5", "new")])
def test_an_unknown_controller_is_explained(model: str, version: str) -> None:
    with pytest.raises(InputError):
        identity(model, version)
