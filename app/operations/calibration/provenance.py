"""What is kept of a cell's calibration, in a folder beside its file: boards, views, results, versions.

`NAME.calibration/board.json`, and for every other step one numbered folder each time: `result.json` when it
is done, and where the arm looks at the board `views.json` and an image a view, written as soon as it is
taken.
"""

from __future__ import annotations

import shutil
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from datetime import datetime, timezone
from importlib.metadata import version
from pathlib import Path
from typing import Any

import numpy as np

from app.operations.calibration import step_names
from core.calibration.board import BoardSpec
from core.calibration.collecting import Look
from core.calibration.views import BoardView
from core.errors import InputError
from core.files import make_folder, read_json, reading, write_json, write_whole
from core.geometry import FloatArray
from core.session import explained

VIEWS, RESULT, WITHDRAWN = "views.json", "result.json", ".withdrawn"
_POSES: dict[str, tuple[str, ...]] = {
    step_names.HAND_EYE: ("before", "after", "T_base_board"),
    step_names.TABLE: ("T_base_board",),
}
"""What a step's result must hold as poses (4, 4)."""
_TOOLS = ("poursight", "opencv-python-headless", "scipy", "numpy")


@dataclass(frozen=True)
class BoardEntry:
    """A board as somebody entered it.

    Attributes:
        board: with squares as measured, or as they should come out of the printer.
        is_measured: whether they were measured on the print.
        time: when it was entered.
    """

    board: BoardSpec
    is_measured: bool
    time: str


def calibration_folder(cell: Path) -> Path:
    """Return the folder beside a cell's file; it need not exist yet."""
    return cell.with_suffix(".calibration")


def now() -> str:
    """Return the time as it is written into records."""
    return datetime.now(timezone.utc).isoformat(timespec="seconds")


def versions() -> dict[str, str]:
    """Return the versions of what a result was computed with."""
    return {name: version(name) for name in _TOOLS}


def read_boards(cell: Path) -> tuple[BoardEntry, ...]:
    """Return the boards that were entered, the newest last.

    Raises:
        SessionError: the file is damaged.
    """
    path = calibration_folder(cell) / "board.json"
    if not path.is_file():
        return ()
    table = read_json(path, None)
    with reading(path):
        try:
            return tuple(
                BoardEntry(BoardSpec(**entry["board"]), bool(entry["is_measured"]), str(entry["time"]))
                for entry in table["boards"]
            )
        except InputError as error:
            raise ValueError(str(error)) from error


def write_boards(cell: Path, entries: Sequence[BoardEntry]) -> None:
    """Keep the boards that were entered.

    Raises:
        SessionError: the disk refuses.
    """
    folder = calibration_folder(cell)
    with explained(folder.parent):
        make_folder(folder)
        write_json(folder / "board.json", {"boards": [asdict(entry) for entry in entries]})


def runs(cell: Path, step: str) -> list[Path]:
    """Return the folders of a step, the newest last, without those that were withdrawn."""
    folders = (calibration_folder(cell) / step).glob("[0-9]" * 4)
    return sorted(folder for folder in folders if folder.is_dir())


def new_run(cell: Path, step: str) -> Path:
    """Make the folder of another run of a step.

    Raises:
        SessionError: the disk refuses.
    """
    root = calibration_folder(cell) / step
    with explained(cell.parent):
        make_folder(root)
        numbers = [int(folder.name[:4]) for folder in root.iterdir() if folder.name[:4].isdecimal()]
        folder = root / f"{max(numbers, default=0) + 1:04d}"
        folder.mkdir()
    return folder


def discard_run(folder: Path) -> None:
    """Take back a run in which nothing was done yet.

    Raises:
        SessionError: the disk refuses.
    """
    with explained(folder.parent):
        shutil.rmtree(folder)


def interrupted_run(cell: Path, step: str) -> Path | None:
    """Return the newest run of a step that looked at the board, if it came to no result; else none."""
    looked = [folder for folder in runs(cell, step) if (folder / VIEWS).is_file()]
    return looked[-1] if looked and not (looked[-1] / RESULT).exists() else None


def latest_result(cell: Path, step: str) -> tuple[Path, dict[str, Any]] | None:
    """Return the newest finished run of a step and its result, whose poses are arrays (4, 4).

    Raises:
        SessionError: the result is damaged.
    """
    for folder in reversed(runs(cell, step)):
        if (folder / RESULT).is_file():
            table = read_json(folder / RESULT, None)
            with reading(folder / RESULT):
                poses = {name: _shaped(table[name], 4, 4) for name in _POSES.get(step, ())}
            return folder, table | poses
    return None


def withdraw(folder: Path) -> None:
    """Let a run count no more; its files stay.

    Raises:
        SessionError: the disk refuses.
    """
    with explained(folder.parent):
        folder.rename(folder.with_name(folder.name + WITHDRAWN))


def write_looks(folder: Path, facts: dict[str, Any], looks: Sequence[Look], image: bytes | None) -> None:
    """Keep the looks of a run; an image (PNG) belongs to the last one.

    Raises:
        SessionError: the disk refuses; what was kept before is whole.
    """
    with explained(folder):
        if image is not None:
            write_whole(folder / f"view-{len(looks):02d}.png", image)
        write_json(folder / VIEWS, facts | {"views": [_look_table(look) for look in looks]})


def read_looks(folder: Path) -> tuple[dict[str, Any], list[Look]]:
    """Return the facts and the looks of a run.

    Raises:
        SessionError: the file is damaged.
    """
    table = read_json(folder / VIEWS, None)
    with reading(folder / VIEWS):
        looks = [_look_from(entry) for entry in table.pop("views")]
    return table, looks


def _look_table(look: Look) -> dict[str, Any]:
    table: dict[str, Any] = {"joints_rad": look.joints_rad.tolist(), "problem": look.problem}
    if look.view is not None:
        table["view"] = {
            "name": look.view.name,
            "T_base_flange": look.view.T_base_flange.tolist(),
            "ids": look.view.ids.tolist(),
            "corners_px": look.view.corners_px.tolist(),
            "T_camera_board": look.view.T_camera_board.tolist(),
        }
    return table


def _look_from(table: dict[str, Any]) -> Look:
    view = None
    if "view" in table:
        seen = table["view"]
        ids = np.array(seen["ids"], dtype=np.int64)
        view = BoardView(
            str(seen["name"]),
            _shaped(seen["T_base_flange"], 4, 4),
            ids,
            _shaped(seen["corners_px"], len(ids), 2),
            _shaped(seen["T_camera_board"], 4, 4),
        )
    return Look(_shaped(table["joints_rad"], 6), view, str(table["problem"]))


def _shaped(values: Any, *shape: int) -> FloatArray:
    array = np.array(values, dtype=float)
    if array.shape != shape or not np.isfinite(array).all():
        raise ValueError(f"an array is not {shape}")
    return array
