"""The very arm that stands in a cell: its own kinematics, and where it was guided to. Nothing moves."""

from __future__ import annotations

import numpy as np

from core.errors import InputError
from core.geometry import FloatArray
from core.motion.factory_calibration import MeasuredKinematics
from hardware.cell.settings import ARMS, CellSettings
from hardware.errors import RobotError
from hardware.interfaces import Kinematics
from hardware.robots.ur.glance import glance
from hardware.robots.ur.own_kinematics import as_measured, read_kinematics


def own_kinematics(settings: CellSettings) -> Kinematics:
    """Return the kinematics of a cell's arm: its own, where a controller tells them."""
    published = ARMS[settings.robot.model]
    if settings.robot.is_real:
        return read_kinematics(_address(settings), published)
    measured = measured_in_simulation(settings)
    return Kinematics(published) if measured is None else as_measured(published, measured)


def measured_in_simulation(settings: CellSettings) -> MeasuredKinematics | None:
    """Return what the maker of a cell's simulated arm measured; none: it is as published."""
    set_up = settings.simulation.set_up
    return None if set_up is None else set_up.measured(ARMS[settings.robot.model])


def why_other_arm(settings: CellSettings, kinematics: Kinematics) -> str:
    """Say that the arm that is there is not the one with which the cell was calibrated; empty if it may be.

    Args:
        settings: of the cell.
        kinematics: of the arm that is there.
    """
    known, found = settings.robot.kinematics_checksum, kinematics.checksum
    if known is None or not found or known == found:
        return ""
    return (
        f"The arm is not the one with which the {settings.name} was calibrated, or was measured anew by its "
        f"maker (kinematics {found}, before {known}), so objects may be seen 1 to 3 mm beside their place; "
        "calibrate the cell again."
    )


def guided_joints_rad(settings: CellSettings) -> FloatArray:
    """Return the joints (6,) of a cell's real arm, which rests where somebody guided it.

    Raises:
        InputError: nobody can guide a simulated arm.
        RobotError: its controller does not answer, or the arm moves.
    """
    if not settings.robot.is_real:
        raise InputError(
            f"The arm of the {settings.name} is simulated, and nobody can guide it by hand; type the "
            "place instead."
        )
    seen = glance(_address(settings))
    if seen.is_moving:
        raise RobotError("The arm moves; let it come to rest where it was guided to, then read again.")
    return np.array(seen.joints_rad)


def _address(settings: CellSettings) -> str:
    address = settings.robot.address
    assert address is not None, "checked by the validator for ur5"
    return address
