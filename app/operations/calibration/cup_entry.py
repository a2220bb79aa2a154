"""A cup as it is entered for a cell: its size, its station, its mass. Imports nothing heavy."""

from __future__ import annotations

from dataclasses import dataclass
from math import atan
from pathlib import Path
from typing import Any

import numpy as np

from core.errors import InputError, MotionError
from core.motion.pour.teaching import taught_station_m
from core.parameters.bodies import CupParameters
from hardware.cell import CellSettings, read_cell
from hardware.cell.own_arm import guided_joints_rad, own_kinematics

DIGITS = 4
"""Places are written to a tenth of a millimetre."""
ON_TABLE_M = 0.01
"""A taught foot that comes out this near to the table's top stands on the table."""
_MASSES = ("payload_kg", "cup_kg")


@dataclass(frozen=True)
class CupEntry:
    """A cup as somebody entered it.

    Attributes:
        station_m: (3,) middle of its foot, in the base frame.
        cup: its size.
        payload_kg: gripper, camera and full cup.
        cup_kg: of that the full cup; 0: the controller is not told when the hand takes it.
    """

    station_m: tuple[float, float, float]
    cup: CupParameters
    payload_kg: float
    cup_kg: float


def entry_of(settings: CellSettings) -> CupEntry:
    """Return what a cell's file has."""
    gripper = settings.gripper
    cup = settings.cup or CupParameters()
    return CupEntry(settings.place.cup_station_m, cup, gripper.payload_kg, gripper.cup_kg)


def measured_cup(length_m: float, mouth_m: float, base_m: float, wall_m: float) -> CupParameters:
    """Return the cup of some measures: length, outer diameters of mouth and base, thickness of the wall.

    Raises:
        InputError: no cup is like that.
    """
    if base_m > mouth_m:
        raise InputError("The cup is wider at its base than at its mouth; measure both once more.")
    if not length_m > 0:
        raise InputError("A cup has a length; measure it.")
    slant_rad = atan((mouth_m - base_m) / 2 / length_m)
    measures = {"length_m": length_m, "mouth_radius_m": mouth_m / 2, "slant_rad": slant_rad, "wall_m": wall_m}
    try:
        return CupParameters.model_validate(measures)
    except ValueError as error:
        raise InputError(
            f"No cup can be {1000 * length_m:g} mm long, {1000 * mouth_m:g} mm wide at its mouth and "
            f"{1000 * base_m:g} mm at its base, with walls of {1000 * wall_m:g} mm; measure it once more."
        ) from error


def changed_cup(
    cup: CupParameters, measures_mm: tuple[float | None, float | None, float | None, float | None]
) -> CupParameters:
    """Return a cup with other measures in mm, those of `measured_cup`; what is none stays as it is."""
    if all(given is None for given in measures_mm):
        return cup
    held_m = (cup.length_m, 2 * cup.mouth_radius_m, base_diameter_m(cup), cup.wall_m)
    given_m = [
        held if given is None else given / 1000 for given, held in zip(measures_mm, held_m, strict=True)
    ]
    return measured_cup(*given_m)


def base_diameter_m(cup: CupParameters) -> float:
    """Return the outer diameter of a cup's base, as `measured_cup` takes it."""
    return 2 * (cup.mouth_radius_m - cup.length_m * float(np.tan(cup.slant_rad)))


def read_taught_station(cell_file: Path) -> tuple[float, float, float]:
    """Return the station (3,) of a cup that the hand was guided to: it holds the standing cup.

    Raises:
        InputError: the cell has no real arm.
        RobotError: its controller does not answer, or the arm moves.
        MotionError: the hand leans, or is too far from the table.
    """
    settings = read_cell(cell_file)
    joints_rad = guided_joints_rad(settings)
    gripper, table_m = settings.gripper, settings.place.table_height_m
    arm = own_kinematics(settings).model
    x, y, z = (
        taught_station_m(arm, joints_rad, gripper.grasp_pose, gripper.grip_height_m).round(DIGITS).tolist()
    )
    if z < table_m - ON_TABLE_M:
        raise MotionError(
            f"The cup's foot would be {1000 * (table_m - z):.0f} mm below the table's top; see whether "
            "grip_height_m and table_height_m in the cell file are right, then read again."
        )
    return x, y, table_m if abs(z - table_m) <= ON_TABLE_M else z


def reach_is_for(settings: CellSettings) -> dict[str, Any]:
    """Return what the arm's reach depends on: with something else it has to be judged anew."""
    parts = {"gripper", "cup", "place", "motion", "obstacles", "camera"}
    table: dict[str, Any] = settings.model_dump(mode="json", include=parts)
    table["camera"] = {name: table["camera"][name] for name in ("T_flange_camera", "size_m")}
    for name in _MASSES:
        table["gripper"].pop(name, None)
    return table | {"home_rad": list(settings.robot.home_rad), "model": settings.robot.model}


def is_cup_in_file(settings: CellSettings, wanted: Any) -> bool:
    """Whether a cell's file holds this cup, its station and its masses."""
    held = values_of(entry_of(settings))
    if settings.cup is None or wanted["cup"] is None:
        return settings.cup is wanted["cup"]
    return all(
        np.allclose(held[section][name], value, atol=10.0**-DIGITS / 2)
        for section in held
        for name, value in wanted[section].items()
    )


def values_of(entry: CupEntry) -> dict[str, Any]:
    """Return what is written into the file, by section."""
    return {
        "place": {"cup_station_m": np.round(entry.station_m, DIGITS).tolist()},
        "gripper": {"payload_kg": entry.payload_kg, "cup_kg": entry.cup_kg},
        "cup": entry.cup.model_dump(mode="json"),
    }
