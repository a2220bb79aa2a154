"""A scan that was interrupted, of which the list of views is damaged, and what reads it."""

from __future__ import annotations

import os
import shutil
from collections.abc import Callable, Iterator
from pathlib import Path
from random import Random

from core.scan.model import CropBox
from hardware.scanning.store import VIEWS_FILE, ScanStore, read_origin, read_plan, read_views
from hardware.scanning.views import ScanPlan, ViewRecord, ViewState, name_views
from tests.fuzz.mutation import damaged_json, replaced
from tests.fuzz.whole_session import N_VIEWS, small_scan

_ORIGIN = {"cell": {"name": "cell", "robot": {"kind": "kinematic"}}, "table_height_m": 0.0, "seed": 3}
_BOX = CropBox((-0.3, -0.5, 0.0), (0.2, -0.1, 0.3))
_JOINTS_RAD = ((0.0, -1.5, 1.5, -1.5, -1.5, 0.0),) * (N_VIEWS + 2)


def prepare_unfinished_scan(base: Path) -> None:
    """Write it: four views of six were taken, one of them poor; one failed."""
    store, scan = ScanStore(base, _ORIGIN), small_scan()
    store.begin(0.02, _BOX)
    store.plan = ScanPlan(_JOINTS_RAD, _BOX, _BOX)
    records = [ViewRecord(view) for view in name_views(_JOINTS_RAD)]
    for index, frame in enumerate(scan.frames):
        records[index] = ViewRecord(records[index].view, ViewState.TAKEN)
        store.write_view(frame, scan.intrinsics, records)
    records[1] = ViewRecord(records[1].view, ViewState.POOR, ("It sees the table 12 mm above its place.",))
    records[-1] = ViewRecord(records[-1].view, ViewState.FAILED, ("The goal of the move touches the table.",))
    store.write_records(records)


def damaged_unfinished_scan(base: Path, folder: Path, pick: Random) -> Iterator[Callable[[], object]]:
    """Damage the list of views, and yield what reads it; what is damaged can be discarded."""
    copy = Path(shutil.copytree(base, folder / "scan-in-progress", copy_function=os.link))
    path = copy / VIEWS_FILE
    content = path.read_bytes()
    path.unlink()
    path.write_bytes(damaged_json(content, pick))
    replaced(path, pick)
    yield lambda: read_views(copy)
    yield lambda: read_origin(copy)
    yield lambda: read_plan(copy)
    yield lambda: _continued(copy)
    yield lambda: _discarded(copy)


def _continued(folder: Path) -> None:
    store = ScanStore(folder, _ORIGIN)
    records = store.begin(0.02, _BOX)
    store.recover(records)
    store.write_records(records)
    assert read_views(folder) == records


def _discarded(folder: Path) -> None:
    store = ScanStore(folder, _ORIGIN)
    store.remove()
    assert store.plan is None and store.begin(0.02, _BOX) == []
