"""Frames and field types of the real-time data exchange (RTDE), protocol version 2.

Source: Universal Robots, article 22229 "Real-Time Data Exchange (RTDE) Guide". All numbers are big-endian; a
frame is its whole size (u16), its kind (u8) and its payload.
"""

from __future__ import annotations

import struct
from collections.abc import Iterator
from enum import IntEnum

HEADER_BYTES = 3
NOT_FOUND = "NOT_FOUND"
IN_USE = "IN_USE"
N_REGISTERS = 48

STRUCT_CODES = {
    "BOOL": "?",
    "UINT8": "B",
    "UINT32": "I",
    "UINT64": "Q",
    "INT32": "i",
    "DOUBLE": "d",
    "VECTOR3D": "3d",
    "VECTOR6D": "6d",
    "VECTOR6INT32": "6i",
    "VECTOR6UINT32": "6I",
}
"""How each RTDE type is packed."""


class Kind(IntEnum):
    """What a frame is for; the letters are the protocol's own."""

    PROTOCOL_VERSION = ord("V")
    CONTROLLER_VERSION = ord("v")
    TEXT_MESSAGE = ord("M")
    DATA = ord("U")
    SETUP_OUTPUTS = ord("O")
    SETUP_INPUTS = ord("I")
    START = ord("S")
    PAUSE = ord("P")


def _typed(**names: str) -> dict[str, str]:
    return {name: kind for kind, text in names.items() for name in text.split()}


def _registers(direction: str) -> dict[str, str]:
    types = {f"{direction}_int_register_{k}": "INT32" for k in range(N_REGISTERS)}
    types |= {f"{direction}_double_register_{k}": "DOUBLE" for k in range(N_REGISTERS)}
    types |= {f"{direction}_bit_register_{k}": "BOOL" for k in range(64, 128)}
    return types | {f"{direction}_bit_registers{bits}": "UINT32" for bits in ("0_to_31", "32_to_63")}


OUTPUT_TYPES = _registers("output") | _typed(
    DOUBLE="timestamp actual_execution_time speed_scaling target_speed_fraction actual_momentum "
    "actual_main_voltage actual_robot_voltage actual_robot_current standard_analog_input0 "
    "standard_analog_input1 standard_analog_output0 standard_analog_output1 io_current tool_analog_input0 "
    "tool_analog_input1 tool_output_current tool_temperature tcp_force_scalar payload "
    "actual_robot_energy_consumed actual_robot_braking_energy_dissipated",
    VECTOR6D="target_q target_qd target_qdd target_current target_moment actual_q actual_qd actual_current "
    "joint_control_output actual_TCP_pose actual_TCP_speed actual_TCP_force target_TCP_pose target_TCP_speed "
    "joint_temperatures actual_joint_voltage tcp_offset ft_raw_wrench payload_inertia actual_current_window",
    VECTOR3D="actual_tool_accelerometer elbow_position elbow_velocity payload_cog",
    VECTOR6INT32="joint_mode",
    UINT64="actual_digital_input_bits actual_digital_output_bits",
    UINT32="runtime_state robot_status_bits safety_status_bits analog_io_types tool_mode tool_output_voltage "
    "euromap67_input_bits euromap67_output_bits script_control_line",
    INT32="robot_mode safety_mode safety_status tool_output_mode",
    UINT8="tool_digital_output0_mode tool_digital_output1_mode",
)
"""Every field that a client may ask for, and its type."""

INPUT_TYPES = _registers("input") | _typed(
    UINT32="speed_slider_mask",
    DOUBLE="speed_slider_fraction standard_analog_output_0 standard_analog_output_1",
    UINT8="standard_digital_output_mask standard_digital_output configurable_digital_output_mask "
    "configurable_digital_output tool_digital_output_mask tool_digital_output standard_analog_output_mask "
    "standard_analog_output_type",
    VECTOR6D="external_force_torque",
)
"""Every field that a client may write, and its type."""


def frame(kind: Kind, payload: bytes = b"") -> bytes:
    """Return a whole frame."""
    return struct.pack(">HB", HEADER_BYTES + len(payload), kind) + payload


def layout(types: list[str]) -> struct.Struct:
    """Return how the values of a recipe follow each other."""
    return struct.Struct(">" + "".join(STRUCT_CODES[kind] for kind in types))


class FrameReader:
    """Cuts a stream of bytes into frames."""

    def __init__(self) -> None:
        """Begin between two frames."""
        self._rest = bytearray()

    def feed(self, data: bytes) -> Iterator[tuple[int, bytes]]:
        """Add received bytes and yield the kind and payload of each frame that is complete.

        Raises:
            ValueError: a frame says that it is shorter than its own header.
        """
        self._rest += data
        while len(self._rest) >= HEADER_BYTES:
            size, kind = struct.unpack_from(">HB", self._rest)
            if size < HEADER_BYTES:
                raise ValueError("a frame shorter than its header")
            if len(self._rest) < size:
                return
            payload = bytes(self._rest[HEADER_BYTES:size])
            del self._rest[:size]
            yield kind, payload
