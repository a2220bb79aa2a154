"""The primary interface: who the controller is, and ten times a second a state with its arm's kinematics.

Source: Universal Robots, "Overview of client interfaces". Of a state's many parts those are there that tell
of the arm: the tool's pose, the kinematics, and what is configured. Scripts, which the real port takes as
well, are not read.
"""

from __future__ import annotations

import asyncio
import struct

from core.motion.arm_models import ArmModel
from core.motion.factory_calibration import MeasuredKinematics
from hardware.robots.ur.pose_vectors import vector_from_pose
from hardware.simulation.set_up import link_checksum
from hardware.simulation.ur_controller.arm import Arm
from hardware.simulation.ur_controller.controller import Controller
from hardware.simulation.ur_controller.identity import MODELS, Identity
from hardware.simulation.ur_controller.link import Link, Network

_EVERY_S = 0.1
_ROBOT_STATE, _ROBOT_MESSAGE, _VERSION_MESSAGE = 16, 20, 3
_CARTESIAN_INFO, _KINEMATICS_INFO, _CONFIGURATION_DATA = 4, 5, 6
_DEFAULTS = (1.05, 1.4, 0.25, 1.2, 0.0)
_MOST_RAD_S2 = 40.0
_PROJECT = b"URControl"
_FROM_CONTROLLER = -2
_NOT_CALIBRATED = 0xFFFFFFFF
_STATUS = 0


class PrimaryLink(Link):
    """One client."""

    name = "primary"

    def __init__(self, network: Network, controller: Controller) -> None:
        """Wait for the connection."""
        super().__init__(network, controller.journal)
        self._controller = controller
        self._next: asyncio.TimerHandle | None = None

    def opened(self) -> None:
        """Say who it is, then how it is."""
        self.send(version_message(self._controller.identity))
        self._send_state()

    def closed(self) -> None:
        """Say no more."""
        if self._next is not None:
            self._next.cancel()

    def received(self, data: bytes) -> None:
        """Nothing is done with it."""

    def _send_state(self) -> None:
        arm = self._controller.arm
        pose = struct.pack(">12d", *arm.tcp_pose(arm.joints_rad), *vector_from_pose(arm.T_flange_tcp))
        self.send(
            robot_state(
                _package(_CARTESIAN_INFO, pose),
                kinematics_info(arm.model, self._controller.measured),
                configuration_data(arm),
            )
        )
        self._next = asyncio.get_running_loop().call_later(_EVERY_S, self._send_state)


def robot_state(*parts: bytes) -> bytes:
    """A state of these sub-packages."""
    return _package(_ROBOT_STATE, b"".join(parts))


def kinematics_info(arm: ArmModel, measured: MeasuredKinematics | None = None) -> bytes:
    """The sub-package of an arm's Denavit-Hartenberg parameters: as measured, else those of its model."""
    if measured is None:
        rows = list(zip((0.0,) * 6, arm.a_m, arm.d_m, arm.alpha_rad, strict=True))
        is_published = arm == MODELS[arm.name]
        checksum = tuple(_NOT_CALIBRATED if is_published else link_checksum(row) for row in rows)
        measured = MeasuredKinematics((0.0,) * 6, arm.a_m, arm.d_m, arm.alpha_rad, checksum)
    numbers = [*measured.theta_rad, *measured.a_m, *measured.d_m, *measured.alpha_rad]
    return _package(_KINEMATICS_INFO, struct.pack(">6I24dI", *measured.checksum, *numbers, _STATUS))


def configuration_data(arm: Arm) -> bytes:
    """The sub-package of what is configured: the range and the highest speed of each joint, among others."""
    motion = [number for speed in arm.safe_speeds_rad_s for number in (speed, _MOST_RAD_S2)]
    model = arm.model
    rows = [*model.a_m, *model.d_m, *model.alpha_rad, *(0.0,) * 6]
    numbers = [*arm.safe_rad.T.ravel(), *motion, *_DEFAULTS, *rows]
    return _package(_CONFIGURATION_DATA, struct.pack(">53d4i", *numbers, 0, 0, 0, 0))


def version_message(identity: Identity) -> bytes:
    """The first package that a client gets."""
    begin = struct.pack(">QbB", 0, _FROM_CONTROLLER, _VERSION_MESSAGE)
    major, minor = identity.version
    version = struct.pack(">BBii", major, minor, 0, 0)
    return _package(
        _ROBOT_MESSAGE, begin + bytes([len(_PROJECT)]) + _PROJECT + version + b"01-01-2024, 00:00:00"
    )


def _package(kind: int, content: bytes) -> bytes:
    return struct.pack(">iB", 5 + len(content), kind) + content
