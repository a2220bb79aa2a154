"""The values of all RTDE output fields: true where the simulation knows them, else zero."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from core.geometry import FloatArray
from hardware.modes import RobotMode, SafetyMode
from hardware.simulation.ur_controller.controller import Controller, RuntimeState
from hardware.simulation.ur_controller.poses import vector_from_pose
from hardware.simulation.ur_controller.rtde_protocol import N_REGISTERS, OUTPUT_TYPES, STRUCT_CODES

Values = tuple[float, ...]

_SAFETY_BITS = {
    SafetyMode.NORMAL: 1 << 0,
    SafetyMode.REDUCED: 1 << 1,
    SafetyMode.PROTECTIVE_STOP: 1 << 2 | 1 << 10,
    SafetyMode.RECOVERY: 1 << 3,
    SafetyMode.SAFEGUARD_STOP: 1 << 4 | 1 << 10,
    SafetyMode.SYSTEM_EMERGENCY_STOP: 1 << 5 | 1 << 7 | 1 << 10,
    SafetyMode.ROBOT_EMERGENCY_STOP: 1 << 6 | 1 << 7 | 1 << 10,
    SafetyMode.VIOLATION: 1 << 8 | 1 << 10,
    SafetyMode.FAULT: 1 << 9 | 1 << 10,
}
_POWER_ON_BIT, _PROGRAM_RUNNING_BIT = 1, 2
_JOINT_RUNNING, _JOINT_POWER_OFF = 253, 239
_POSES = {"tcp_offset", "actual_TCP_pose", "actual_TCP_speed", "target_TCP_pose", "target_TCP_speed"}


class Outputs:
    """Makes the values for a cycle, each only if somebody asked for it."""

    def __init__(self, controller: Controller) -> None:
        """Watch a controller."""
        self._controller = controller
        self._values: dict[str, Values] = {name: _zeros(kind) for name, kind in OUTPUT_TYPES.items()}
        self._posed: tuple[FloatArray, ...] = (np.empty(0), np.empty(0), np.empty(0))

    def refresh(self, names: Iterable[str]) -> dict[str, Values]:
        """Return the values of now; those that take time only if they are among the names."""
        self._refresh_state()
        self._refresh_joints()
        self._refresh_registers()
        if not _POSES.isdisjoint(names):
            self._refresh_poses()
        return self._values

    def _refresh_state(self) -> None:
        c, values = self._controller, self._values
        is_powered = c.robot_mode not in (RobotMode.POWER_OFF, RobotMode.DISCONNECTED)
        is_playing = c.runtime_state in (RuntimeState.PLAYING, RuntimeState.RESUMING)
        values["timestamp"] = (c.time_s,)
        values["actual_execution_time"] = (c.dt_s / 4,)
        values["robot_mode"] = (int(c.robot_mode),)
        values["safety_mode"] = values["safety_status"] = (int(c.safety_mode),)
        values["runtime_state"] = (int(c.runtime_state),)
        values["robot_status_bits"] = (_POWER_ON_BIT * is_powered | _PROGRAM_RUNNING_BIT * is_playing,)
        values["safety_status_bits"] = (_SAFETY_BITS.get(c.safety_mode, 0),)
        values["speed_scaling"] = (1.0,)
        values["target_speed_fraction"] = (c.arm.slider,)
        values["actual_digital_output_bits"] = (c.digital_outputs,)
        values["payload"] = (c.arm.payload_kg,)
        values["payload_cog"] = c.arm.payload_center_m
        values["joint_mode"] = (_JOINT_RUNNING if is_powered else _JOINT_POWER_OFF,) * 6
        values["actual_main_voltage"] = values["actual_robot_voltage"] = (48.0,)

    def _refresh_joints(self) -> None:
        arm, values = self._controller.arm, self._values
        values["actual_q"] = tuple(arm.joints_rad.tolist())
        values["actual_qd"] = tuple(arm.speeds_rad_s.tolist())
        values["target_q"] = tuple(arm.target_rad.tolist())
        values["target_qd"] = tuple(arm.target_speeds_rad_s.tolist())

    def _refresh_registers(self) -> None:
        registers, values = self._controller.registers, self._values
        for k in range(N_REGISTERS):
            values[_INT_NAMES[k]] = (registers.ints[k],)
            values[_DOUBLE_NAMES[k]] = (registers.doubles[k],)

    def _refresh_poses(self) -> None:
        """The arm's kinematics take most of a cycle's time: they are left out while nothing has moved."""
        arm, values = self._controller.arm, self._values
        posed = (arm.joints_rad, arm.target_rad, arm.T_flange_tcp)
        is_same = all(new is old for new, old in zip(posed, self._posed, strict=True))
        is_still = not arm.speeds_rad_s.any() and not arm.target_speeds_rad_s.any()
        if is_same and is_still and values["actual_TCP_speed"] == (0.0,) * 6:
            return
        self._posed = posed
        values["tcp_offset"] = _numbers(vector_from_pose(arm.T_flange_tcp))
        values["actual_TCP_pose"] = _numbers(arm.tcp_pose(arm.joints_rad))
        values["actual_TCP_speed"] = _numbers(arm.tcp_speed(arm.joints_rad, arm.speeds_rad_s))
        if arm.target_rad is arm.joints_rad:
            values["target_TCP_pose"] = values["actual_TCP_pose"]
            values["target_TCP_speed"] = values["actual_TCP_speed"]
        else:
            values["target_TCP_pose"] = _numbers(arm.tcp_pose(arm.target_rad))
            values["target_TCP_speed"] = _numbers(arm.tcp_speed(arm.target_rad, arm.target_speeds_rad_s))


_INT_NAMES = [f"output_int_register_{k}" for k in range(N_REGISTERS)]
_DOUBLE_NAMES = [f"output_double_register_{k}" for k in range(N_REGISTERS)]


def _zeros(kind: str) -> Values:
    code = STRUCT_CODES[kind]
    return (0,) * int(code[:-1] or 1)


def _numbers(array: FloatArray) -> Values:
    return tuple(array.tolist())
