"""The arm and the camera of a cell, tried without moving anything; what was found is kept."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from app.operations.calibration import step_names
from app.operations.calibration.provenance import RESULT, new_run, now, versions
from core.errors import InputError
from core.files import write_json
from core.session import explained
from hardware.cell import read_cell
from hardware.cell.examination import Finding, examine_camera, examine_gripper, examine_robot
from hardware.cell.settings import CellSettings

_SET_BY_CALIBRATION = {"T_flange_camera"}


def examine_device(cell_file: Path, step: str) -> Finding:
    """Try a cell's arm or camera.

    Args:
        cell_file: of the cell.
        step: `arm` or `camera`.

    Raises:
        InputError: the cell's file cannot be used, or plays a recording.
        SessionError: the disk refuses.
    """
    settings = read_cell(cell_file)
    if settings.robot.kind == "replay":
        raise InputError(f"The {settings.name} plays back a recorded scan; it has no devices to set up.")
    finding = _arm_with_gripper(settings) if step == step_names.ARM else examine_camera(settings)
    folder = new_run(cell_file, step)
    table = {"time": now(), "said": finding.value, "problem": finding.problem or ""}
    with explained(folder):
        write_json(folder / RESULT, table | {"device": device_table(settings, step), "versions": versions()})
    return finding


def _arm_with_gripper(settings: CellSettings) -> Finding:
    """What the arm is, and what is in its hand; the first problem."""
    arm, gripper = examine_robot(settings), examine_gripper(settings)
    return Finding(arm.subject, f"{arm.value}; gripper: {gripper.value}", arm.problem or gripper.problem)


def device_table(settings: CellSettings, step: str) -> dict[str, Any]:
    """Return what the file says of a device: with something else there it has to be tried again."""
    if step == step_names.ARM:
        return settings.robot.model_dump(mode="json", include={"kind", "address", "model"})
    assert step == step_names.CAMERA, "there are two devices"
    return settings.camera.model_dump(mode="json", exclude=_SET_BY_CALIBRATION)
