"""Cell files: made anew, found by name, and changed with their comments kept."""

from __future__ import annotations

import os
import re
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import tomlkit
from platformdirs import user_documents_path

from app.library.places import slug
from core.errors import InputError
from core.files import make_folder, read_content, reason, write_whole
from core.geometry import FloatArray
from core.session import explained
from hardware.cell.links import LinkSettings
from hardware.cell.reading import CELL_FOLDER, SIMULATED_CELL, read_cell
from hardware.cell.settings import CellSettings
from hardware.interfaces import Kinematics
from hardware.simulation.set_up import random_camera_pose

CELLS_VARIABLE = "POURSIGHT_CELLS"
"""The environment variable that names another folder."""
_REAL_CELL = CELL_FOLDER / "ur5_example.toml"
_BOARD_OFF_PLATFORM_M = (0.03, -0.02, 0.004)
_LINK_ERROR_M, _LINK_ERROR_RAD = 0.0006, 0.0006
"""As the arms of `make own-kinematics`, whose tool is some 2 mm beside where published kinematics have it."""
_DISTORTION = (0.12, -0.25, 0.0008, -0.0006, 0.0)
"""Some pixels towards the image's corners, as of a small colour camera."""
_OF_ARM = ("kinematics_checksum", "own_kinematics")
_DIGITS = 9
_LONGEST_NAME = 100
"""Sentences name a cell."""
_LONGEST_ADDRESS = 253
"""Of a host in the network."""


def cells_folder() -> Path:
    """Return the folder that holds the cells' files; it need not exist yet."""
    chosen = os.environ.get(CELLS_VARIABLE)
    return Path(chosen).absolute() if chosen else user_documents_path() / "Poursight" / "cells"


def cell_path(name: str) -> Path:
    """Return the file of a cell: the path itself if it is one, else that of this name.

    Raises:
        InputError: there is no such file.
    """
    given = Path(name)
    is_path = given.suffix == ".toml" or given.is_file()
    path = given if is_path else cells_folder() / f"{slug(name)}.toml"
    if not path.is_file():
        raise InputError(f"There is no cell file {path}; make one, or name one that there is.")
    return path


def known_cells() -> tuple[Path, ...]:
    """Return the files in the cells' folder."""
    return tuple(sorted(cells_folder().glob("*.toml")))


def new_cell(name: str, is_simulated: bool, seed: int = 0, address: str | None = None) -> Path:
    """Write a new cell's file, to be completed step by step; return its path.

    A simulated cell's camera really hangs up to 20 mm and 10 degrees beside where the file believes, its lens
    distorts, and its arm's links are not those that are published.

    Args:
        name: of the cell.
        is_simulated: whether it has no real devices.
        seed: of a simulated cell's truth.
        address: of a real arm's controller.

    Raises:
        InputError: the name is empty or taken, or name or address are too long.
        SessionError: the file cannot be written.
    """
    if not re.search(r"\w", name):
        raise InputError("A cell needs a name with letters or digits; type one.")
    if len(name) > _LONGEST_NAME:
        raise InputError(f"A cell's name has at most {_LONGEST_NAME} signs; type a shorter one.")
    if len(address or "") > _LONGEST_ADDRESS:
        raise InputError(f"An address has at most {_LONGEST_ADDRESS} signs; type the controller's.")
    path = cells_folder() / f"{slug(name)}.toml"
    if path.exists():
        raise InputError(f"There is a cell {path} already; choose another name.")
    template = SIMULATED_CELL if is_simulated else _REAL_CELL
    document = tomlkit.parse(read_content(template).decode("utf-8"))
    document["name"] = name
    if address is not None:
        _table(document, "robot")["address"] = address
    if is_simulated:
        _table(document, "simulation")["set_up"] = _simulated_set_up(read_cell(template), seed)
    content = tomlkit.dumps(document)
    with explained(path.parent):
        make_folder(path.parent)
        write_whole(path, content)
    return path


def write_hand_eye(path: Path, T_flange_camera: FloatArray, kinematics: Kinematics | None = None) -> None:
    """Put another hand-eye pose (4, 4) into a cell's file; all else in it stays, comments too.

    Args:
        path: of the file.
        T_flange_camera: the pose.
        kinematics: of the arm by which it was found; none, or without a checksum: not known.

    Raises:
        InputError: the file cannot be read, or would be no cell any more; it stays as it was.
        SessionError: it cannot be written; it stays as it was.
    """
    arm: dict[str, Any] = {}
    if kinematics is not None and kinematics.checksum and kinematics.measured is not None:
        links = {name: list(getattr(kinematics.measured, name)) for name in LinkSettings.model_fields}
        arm = {"kinematics_checksum": kinematics.checksum, "own_kinematics": links}
    write_former_hand_eye(path, T_flange_camera, arm)


def write_former_hand_eye(path: Path, T_flange_camera: FloatArray, arm: dict[str, Any]) -> None:
    """Put back a hand-eye pose, and what `arm_table` had of the arm by which it was found; see above."""

    def change(document: tomlkit.TOMLDocument) -> None:
        _table(document, "camera")["T_flange_camera"] = _matrix(T_flange_camera)
        robot = _table(document, "robot")
        for name in _OF_ARM:
            robot.pop(name, None)
            value = arm.get(name)
            if value is not None:
                robot[name] = tomlkit.item(value)

    _changed(path, change)


def arm_table(settings: CellSettings) -> dict[str, Any]:
    """Return what a cell's file has of the arm by which its hand-eye pose was found; nothing: not known."""
    table: dict[str, Any] = settings.robot.model_dump(mode="json", include=set(_OF_ARM))
    return {name: value for name, value in table.items() if value is not None}


def write_place(path: Path, places: dict[str, Any]) -> None:
    """Put other values of `place` into a cell's file; see `write_hand_eye`."""

    def change(document: tomlkit.TOMLDocument) -> None:
        for name, value in places.items():
            _table(document, "place")[name] = value

    _changed(path, change)


def write_views(path: Path, views_rad: Sequence[Sequence[float]]) -> None:
    """Put other views, joints (6,) each, into a cell's file; see `write_hand_eye`."""

    def change(document: tomlkit.TOMLDocument) -> None:
        _table(document, "scan")["views_rad"] = _lines(views_rad)

    _changed(path, change)


def write_cup(path: Path, values: dict[str, Any]) -> None:
    """Put other values of `place`, `gripper` and `cup`, by section, into a cell's file; see `write_hand_eye`.

    A section that is none is taken out.
    """

    def change(document: tomlkit.TOMLDocument) -> None:
        for section, table in values.items():
            if table is None:
                document.pop(section, None)
                continue
            if section not in document:
                document[section] = tomlkit.table()
            for name, value in table.items():
                _table(document, section)[name] = value

    _changed(path, change)


def _changed(path: Path, change: Callable[[tomlkit.TOMLDocument], None]) -> None:
    before = read_content(path)
    try:
        document = tomlkit.parse(before.decode("utf-8"))
        change(document)
    except (ValueError, LookupError, TypeError) as error:
        raise InputError(f"The cell file {path} cannot be changed ({reason(error)}); correct it.") from error
    with explained(path.parent):
        write_whole(path, tomlkit.dumps(document))
    try:
        read_cell(path)
    except InputError:
        write_whole(path, before)
        raise


def _table(document: tomlkit.TOMLDocument, name: str) -> Any:
    return document[name]


def _matrix(T: FloatArray) -> Any:
    """A pose (4, 4) as an array of four lines."""
    return _lines(T.round(_DIGITS).tolist())


def _lines(values: Sequence[Sequence[float]]) -> Any:
    """An array of arrays, a line each."""
    rows = tomlkit.array()
    for row in values:
        rows.append(tomlkit.item([value + 0.0 for value in row]))
    rows.multiline(True)
    return rows


def _simulated_set_up(settings: CellSettings, seed: int) -> Any:
    table = tomlkit.table()
    table.add(tomlkit.comment("What this simulated cell really is, which its calibration has to find."))
    table["T_flange_camera"] = _matrix(random_camera_pose(settings.camera.pose, seed))
    middle_m = settings.place.platform_center_m + _BOARD_OFF_PLATFORM_M
    table["board_middle_m"] = [round(value, 6) for value in middle_m.tolist()]
    table["link_error_m"], table["link_error_rad"] = _LINK_ERROR_M, _LINK_ERROR_RAD
    table["distortion"] = list(_DISTORTION)
    table["seed"] = seed
    return table
