"""How the worker reads one state of the arm out of ur_rtde's receiving interface."""

from __future__ import annotations

import time
from typing import Protocol

import numpy as np

from core.geometry import AnyArray
from hardware.robots.ur.messages import FIELDS

RECEIVED = (
    "timestamp",
    "actual_q",
    "target_q",
    "actual_qd",
    "actual_TCP_pose",
    "actual_TCP_force",
    "speed_scaling",
    "target_speed_fraction",
    "robot_mode",
    "safety_mode",
    "runtime_state",
    "actual_digital_output_bits",
    "payload",
)
"""The RTDE output fields that are read; ur_rtde would ask for five times as many."""


class Receive(Protocol):
    """What is used of ur_rtde's receiving interface."""

    def getTimestamp(self) -> float: ...  # noqa: D102

    def getActualQ(self) -> list[float]: ...  # noqa: D102

    def getTargetQ(self) -> list[float]: ...  # noqa: D102

    def getActualQd(self) -> list[float]: ...  # noqa: D102

    def getActualTCPPose(self) -> list[float]: ...  # noqa: D102

    def getActualTCPForce(self) -> list[float]: ...  # noqa: D102

    def getSpeedScalingCombined(self) -> float: ...  # noqa: D102

    def getRobotMode(self) -> int: ...  # noqa: D102

    def getSafetyMode(self) -> int: ...  # noqa: D102

    def getRuntimeState(self) -> int: ...  # noqa: D102

    def getActualDigitalOutputBits(self) -> int: ...  # noqa: D102


def read_state(receive: Receive) -> AnyArray:
    """Return one state, a scalar of `FIELDS`; read again when a new one came in the middle of it.

    Waits until there is a first one. `progress` and `due_s` are the worker's, and left at zero.
    """
    raw = np.zeros((), FIELDS)
    while raw["controller_s"] != (stamp_s := receive.getTimestamp()) or not stamp_s:
        raw["controller_s"] = stamp_s
        raw["time_s"] = time.monotonic()
        raw["joints_rad"] = receive.getActualQ()
        raw["target_joints_rad"] = receive.getTargetQ()
        raw["joint_speeds_rad_s"] = receive.getActualQd()
        raw["tool_pose"] = receive.getActualTCPPose()
        raw["speed_scaling"] = receive.getSpeedScalingCombined()
        raw["robot_mode"] = receive.getRobotMode()
        raw["safety_mode"] = receive.getSafetyMode()
        raw["runtime_state"] = receive.getRuntimeState()
        raw["output_bits"] = receive.getActualDigitalOutputBits()
        raw["tool_force_n"] = np.linalg.norm(receive.getActualTCPForce()[:3])
    return raw
