"""Reading where an arm was guided to by hand, and its own kinematics, without connecting or moving it."""

from __future__ import annotations

import numpy as np

from core.errors import InputError
from core.geometry import FloatArray
from hardware.cell.settings import ARMS, CellSettings
from hardware.errors import RobotError
from hardware.interfaces import Kinematics
from hardware.robots.ur.glance import glance
from hardware.robots.ur.own_kinematics import read_kinematics


def own_kinematics(settings: CellSettings) -> Kinematics:
    """Return the kinematics of a cell's arm: its own, where a controller tells them."""
    published = ARMS[settings.robot.model]
    if not settings.robot.is_real:
        return Kinematics(published)
    return read_kinematics(_address(settings), published)


def guided_joints_rad(settings: CellSettings) -> FloatArray:
    """Return the joints (6,) of a cell's real arm, which rests where somebody guided it.

    Raises:
        InputError: nobody can guide a simulated arm.
        RobotError: its controller does not answer, or the arm moves.
    """
    if not settings.robot.is_real:
        raise InputError(
            f"The arm of the {settings.name} is simulated, and nobody can guide it by hand; type where the "
            "cup stands."
        )
    seen = glance(_address(settings))
    if seen.is_moving:
        raise RobotError("The arm moves; let it come to rest where its hand holds the cup, then read again.")
    return np.array(seen.joints_rad)


def _address(settings: CellSettings) -> str:
    address = settings.robot.address
    assert address is not None, "checked by the validator for ur5"
    return address
