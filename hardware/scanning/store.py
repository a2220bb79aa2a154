"""A scan in progress on the disk: every view is there, whole, before the arm moves on.

The folder holds the authors' layout and `views.json`, so that what was taken before a crash, a kill or a full
disk can be continued.
"""

from __future__ import annotations

import shutil
from dataclasses import asdict
from pathlib import Path
from typing import Any

from core.errors import Remedy, SessionError
from core.files import read_json, write_json
from core.formats.scans import Views
from core.progress import Reporter
from core.scan import RgbdFrame, Scan, read_scan, write_camera, write_frame
from core.scan.authors_layout import FRAMES_FOLDER
from core.scan.model import CropBox, Intrinsics, crop_box
from core.scan.view_files import ENDINGS
from core.session import explained
from core.session.record import RECORD_FILE
from hardware.scanning.views import PlannedView, ScanPlan, ViewRecord, ViewState

VIEWS_FILE = "views.json"


class ScanStore:
    """Writes views as they come and gives back those of an interrupted scan.

    Attributes:
        folder: where they are.
    """

    def __init__(self, folder: Path, origin: dict[str, Any]) -> None:
        """`origin` says, as plain JSON, which scan this is: views of another one are refused."""
        self.folder = folder
        self._origin = origin
        self._camera: Intrinsics | None = None
        self._plan: ScanPlan | None = None

    @property
    def has_begun(self) -> bool:
        """Whether the folder holds views."""
        return (self.folder / VIEWS_FILE).exists()

    @property
    def plan(self) -> ScanPlan | None:
        """From where the scan is taken; none before that is planned, nor in scans of before there were plans.

        It is written with the views.

        Raises:
            SessionError: the file is damaged.
        """
        # Not read before: whoever discards the views need not be able to read them.
        self._plan = self._plan or read_plan(self.folder)
        return self._plan

    @plan.setter
    def plan(self, plan: ScanPlan) -> None:
        self._plan = plan

    def begin(self, platform_height_m: float, crop_box: CropBox) -> list[ViewRecord]:
        """Prepare the folder and return what became of the views of an interrupted scan.

        Raises:
            SessionError: the folder holds views of another scan, or cannot be written.
        """
        self._place = platform_height_m, crop_box
        with explained(self.folder):
            self.folder.mkdir(parents=True, exist_ok=True)
        if not self.has_begun:
            return []
        table = _read(self.folder)
        self._plan = self._plan or _plan(table)
        records = _records(table)
        if table.get("origin") != self._origin:
            n_taken = sum(record.has_image for record in records)
            raise SessionError(
                f"{self.folder} holds views of another scan ({n_taken}, of another cell, object or seed); "
                "finish that one first, or discard them.",
                Remedy.RESTART_SCAN,
            )
        return records

    def recover(self, records: list[ViewRecord]) -> Scan | None:
        """Read the images of an interrupted scan; views not recorded or not whole are removed."""
        images = self.folder / FRAMES_FOLDER
        names = [record.view.name for record in records if record.has_image]
        recorded = {name for name in names if all((images / (name + end)).exists() for end in ENDINGS)}
        for path in images.glob("*"):
            if path.name.split(".")[0] not in recorded:
                path.unlink()
        if not recorded:
            return None
        scan = read_scan(self.folder, Reporter())
        self._camera = scan.intrinsics
        return scan

    def adopt(self, finished: Path) -> None:
        """Begin with the views of a finished scan, to take more or some of them again.

        Raises:
            SessionError: the folder cannot be written.
        """
        with explained(self.folder):
            shutil.copytree(
                finished, self.folder, ignore=shutil.ignore_patterns(RECORD_FILE, "warnings.json")
            )
        self._plan = None

    def publish(self, stage: Path) -> None:
        """Copy everything into a stage's empty folder."""
        shutil.copytree(self.folder, stage, dirs_exist_ok=True)

    def remove(self) -> None:
        """Throw everything away."""
        shutil.rmtree(self.folder, ignore_errors=True)
        self._plan = None

    def write_view(self, frame: RgbdFrame, intrinsics: Intrinsics, records: list[ViewRecord]) -> None:
        """Write a view, and what became of all so far.

        Raises:
            SessionError: the disk is full or may not be written.
        """
        with explained(self.folder):
            if self._camera is None:
                write_camera(intrinsics, self._place[0], self.folder, self._place[1])
                self._camera = intrinsics
            write_frame(frame, self.folder)
        self.write_records(records)

    def write_records(self, records: list[ViewRecord]) -> None:
        """Write what became of the views so far."""
        views = [asdict(record.view) | _outcome(record) for record in records]
        with explained(self.folder):
            write_json(
                self.folder / VIEWS_FILE,
                {
                    "origin": self._origin,
                    "plan": None if self._plan is None else asdict(self._plan),
                    "views": views,
                },
            )


def read_views(folder: Path) -> list[ViewRecord]:
    """Return the views that a finished scan's folder records; none when it was imported.

    Raises:
        SessionError: the file is damaged.
    """
    if not (folder / VIEWS_FILE).exists():
        return []
    return _records(_read(folder))


def read_origin(folder: Path) -> dict[str, Any]:
    """Return which scan the views in a folder belong to, as given to `ScanStore`; empty if nothing says so.

    Raises:
        SessionError: the file is damaged.
    """
    if not (folder / VIEWS_FILE).exists():
        return {}
    origin: dict[str, Any] = _read(folder).get("origin", {})
    return origin


def read_plan(folder: Path) -> ScanPlan | None:
    """Return from where the views in a folder are taken; none if nothing says so.

    Raises:
        SessionError: the file is damaged.
    """
    return _plan(_read(folder)) if (folder / VIEWS_FILE).exists() else None


def _plan(table: dict[str, Any]) -> ScanPlan | None:
    plan = table.get("plan")
    if plan is None:
        return None
    return ScanPlan(
        tuple(tuple(map(float, row)) for row in plan["views_rad"]),
        crop_box(plan["crop_box"]["min_m"], plan["crop_box"]["max_m"]),
        crop_box(plan["keep_out"]["min_m"], plan["keep_out"]["max_m"]),
    )


def _outcome(record: ViewRecord) -> dict[str, Any]:
    return {"state": record.state.value, "problems": list(record.problems)}


def _records(table: dict[str, Any]) -> list[ViewRecord]:
    return [
        ViewRecord(
            PlannedView(view["name"], tuple(map(float, view["joints_rad"]))),
            ViewState(view["state"]),
            tuple(view["problems"]),
        )
        for view in table["views"]
    ]


def _read(folder: Path) -> dict[str, Any]:
    try:
        return read_json(folder / VIEWS_FILE, Views)
    except SessionError as error:
        raise SessionError(str(error), Remedy.RESTART_SCAN) from error
