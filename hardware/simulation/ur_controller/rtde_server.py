"""The real-time data exchange: the values of its output fields, and one connection with its recipes."""

from __future__ import annotations

import struct
from collections.abc import Iterable
from dataclasses import dataclass

from core.geometry import FloatArray
from hardware.modes import RobotMode, SafetyMode
from hardware.robots.ur.pose_vectors import vector_from_pose
from hardware.simulation.ur_controller.controller import TOOL_OUTPUT_BIT, Controller, RuntimeState
from hardware.simulation.ur_controller.link import Link, Network
from hardware.simulation.ur_controller.rtde_protocol import (
    IN_USE,
    N_REGISTERS,
    NOT_FOUND,
    OUTPUT_TYPES,
    STRUCT_CODES,
    FrameReader,
    Kind,
    frame,
    layout,
)

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
        self._posed: tuple[object, ...] = (None,) * 4

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
        values["tool_output_voltage"] = (c.tool_voltage_v,)
        values["tool_output_mode"] = (int(c.has_dual_pin_power),)
        values["tcp_force_scalar"] = (c.tool_force_n,)
        values["actual_TCP_force"] = (0.0, 0.0, -c.tool_force_n, 0.0, 0.0, 0.0)
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
        posed = (arm.joints_rad, arm.target_rad, arm.T_flange_tcp, arm.model)
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


_PROTOCOL = 2
_MAX_RECIPES = 255
_CONFIGURABLE_SHIFT = 8
_DIGITAL_OUTPUTS = {
    "standard_digital_output": 0,
    "configurable_digital_output": _CONFIGURABLE_SHIFT,
    "tool_digital_output": TOOL_OUTPUT_BIT,
}
"""Where the bits of each group of outputs begin."""


@dataclass(frozen=True)
class _Recipe:
    """Fields that come together, in this order."""

    names: list[str]
    layout: struct.Struct


class RtdeLink(Link):
    """One client of the data exchange."""

    name = "rtde"

    def __init__(self, network: Network, controller: Controller) -> None:
        """Wait for the client's set-up."""
        super().__init__(network, controller.journal)
        self._controller = controller
        self._reader = FrameReader()
        self._inputs: dict[int, _Recipe] = {}
        self._output: _Recipe | None = None
        self._every = 1
        self._cycle = 0
        self._is_started = False

    @property
    def wanted(self) -> list[str]:
        """The fields that the client wants now."""
        return self._output.names if self._output is not None and self._is_started else []

    def closed(self) -> None:
        """Give back the registers."""
        self._is_started = False
        self._controller.registers.release(self)

    def received(self, data: bytes) -> None:
        """Take the client's frames."""
        try:
            for kind, payload in self._reader.feed(data):
                self._take_frame(kind, payload)
        except (ValueError, struct.error, UnicodeDecodeError) as error:
            self._journal.note("bad frame", message=str(error))
            self.abort()

    @property
    def cycles_to_next(self) -> int:
        """How many cycles from now on its next state is due."""
        return self._every - self._cycle

    def is_due(self, cycles: int) -> bool:
        """Whether a state is to be sent now; `cycles` have passed since the last call."""
        self._cycle += cycles
        if self._cycle < self._every:
            return False
        self._cycle %= self._every
        return True

    def send_state(self, values: dict[str, Values]) -> None:
        """Send the fields that the client wants; it has begun to."""
        assert self._output is not None, "it is served"
        flat = [number for name in self._output.names for number in values[name]]
        self.send(frame(Kind.DATA, b"\x01" + self._output.layout.pack(*flat)))

    def _take_frame(self, kind: int, payload: bytes) -> None:
        if kind == Kind.DATA:
            self._take_data(payload)
        elif kind == Kind.PROTOCOL_VERSION:
            (version,) = struct.unpack(">H", payload)
            self.send(frame(Kind.PROTOCOL_VERSION, bytes([version == _PROTOCOL])))
        elif kind == Kind.CONTROLLER_VERSION:
            major, minor = self._controller.identity.version
            self.send(frame(Kind.CONTROLLER_VERSION, struct.pack(">4I", major, minor, 0, 0)))
        elif kind == Kind.SETUP_OUTPUTS:
            self._set_up_outputs(payload)
        elif kind == Kind.SETUP_INPUTS:
            self._set_up_inputs(payload)
        elif kind in (Kind.START, Kind.PAUSE):
            is_taken = self._output is not None or kind == Kind.PAUSE
            self._is_started = is_taken and kind == Kind.START
            self.send(frame(Kind(kind), bytes([is_taken])))
        else:
            self._journal.note("text message" if kind == Kind.TEXT_MESSAGE else "unknown frame", kind=kind)

    def _set_up_outputs(self, payload: bytes) -> None:
        (frequency_hz,) = struct.unpack_from(">d", payload)
        names = _names(payload[8:])
        types = [OUTPUT_TYPES.get(name, NOT_FOUND) for name in names]
        unknown = [name for name in names if name not in OUTPUT_TYPES]
        self._journal.note("outputs", names=names, frequency_hz=frequency_hz, unknown=unknown)
        if not unknown:
            self._output = _Recipe(names, layout(types))
            rate_hz = self._controller.identity.rate_hz
            self._every = max(1, round(rate_hz / frequency_hz)) if frequency_hz > 0 else 1
        self.send(frame(Kind.SETUP_OUTPUTS, bytes([not unknown]) + ",".join(types).encode()))

    def _set_up_inputs(self, payload: bytes) -> None:
        names = _names(payload)
        types = self._controller.registers.claim(names, self)
        is_fine = not {IN_USE, NOT_FOUND} & set(types) and len(self._inputs) < _MAX_RECIPES
        number = len(self._inputs) + 1 if is_fine else 0
        self._journal.note("inputs", names=names, recipe=number)
        if is_fine:
            self._inputs[number] = _Recipe(names, layout(types))
        self.send(frame(Kind.SETUP_INPUTS, bytes([number]) + ",".join(types).encode()))

    def _take_data(self, payload: bytes) -> None:
        recipe = self._inputs.get(payload[0])
        if recipe is None:
            self._journal.note("data without a recipe", recipe=payload[0])
            return
        missing = recipe.layout.size + 1 - len(payload)
        if missing:
            # Clients do not check the length of vectors. What is too much is left, what is too little is not
            # taken at all; what a real controller does with either is not known.
            self._journal.note("data of a wrong length", recipe=payload[0], missing_bytes=missing)
        if missing > 0:
            return
        values = dict(zip(recipe.names, recipe.layout.unpack_from(payload, 1), strict=True))
        for name, value in values.items():
            self._controller.registers.write(name, value)
        self._switch_outputs(values)

    def _switch_outputs(self, values: dict[str, float]) -> None:
        controller = self._controller
        if values.get("speed_slider_mask"):
            controller.arm.slider = min(max(float(values["speed_slider_fraction"]), 0.0), 1.0)
            self._journal.note("slider", fraction=controller.arm.slider)
        if controller.ignores_outputs:
            return
        for group, shift in _DIGITAL_OUTPUTS.items():
            mask = int(values.get(f"{group}_mask", 0))
            if mask:
                bits = int(values[group]) & mask
                controller.digital_outputs &= ~(mask << shift)
                controller.digital_outputs |= bits << shift
                self._journal.note("digital outputs", group=group, mask=mask, bits=bits)


def _names(text: bytes) -> list[str]:
    return [name for name in text.decode("ascii").split(",") if name]
