"""Scanning: the views of an object in a cell, stored in a session, and further views worth taking."""

from __future__ import annotations

import hashlib
import json
from contextlib import nullcontext
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from app.library.session_folder import UNFINISHED_SCAN
from app.operations.animating import animated
from app.operations.arm import connected
from app.operations.scan_run import ScanObserver, ScanOperator, ScanRequest, ScanRun, Watch
from core.errors import InputError, StageError
from core.files import is_file
from core.formats import excerpt
from core.progress import Reporter

if TYPE_CHECKING:
    from core.mesh import TriangleMesh
    from core.pipeline.pipeline import Pipeline
    from hardware.cell import Cell, CellSettings
    from hardware.scanning.store import ScanStore

SCAN_RUNS_FOLDER = "scans"
"""Of a session: what a real arm did in each scan."""


@dataclass(frozen=True)
class Proposal:
    """Views that would show more of the inside; what `propose_views` returns.

    Attributes:
        n_views: how many; zero if none would show more.
        revealed_share: of what is hidden inside openings, 0 to 1, as far as can be known beforehand.
    """

    n_views: int
    revealed_share: float


def scan_object(
    pipeline: Pipeline,
    settings: CellSettings,
    source: str | None,
    request: ScanRequest | None = None,
    observer: ScanObserver | None = None,
    operator: ScanOperator | None = None,
) -> None:
    """Scan in a cell, continuing what was interrupted; nothing is done when the session holds this very scan.

    Args:
        pipeline: of the session; its seed is that of a simulated cell.
        settings: the cell.
        source: for a simulated cell, a built-in object's name or a mesh file.
        request: what to do beyond that; by default nothing.
        observer: of whoever follows it; a simulated arm then moves where it would jump.
        operator: confirms what a real arm does; without one nothing real moves.

    Raises:
        PoursightError: the sentence says what is in the way; no view that was taken is lost.
    """
    from hardware.scanning.store import ScanStore

    request = request or ScanRequest()
    is_replay = settings.camera.kind == "replay"
    if is_replay and (request.adaptive or request.retake):
        raise InputError(
            "A recorded scan cannot be taken again, nor can views be added to it; scan in another cell."
        )
    mesh = object_mesh(source, pipeline.reporter) if source is not None else None
    if settings.robot.is_real and operator is None:
        raise InputError(f"Nobody is there to confirm the motions of the arm of the {settings.name}.")
    seed = pipeline.parameters.seed
    origin = _origin(settings, source, mesh, seed)
    if request.cell_file is not None and not is_replay:
        origin |= _known_camera_error(request.cell_file, settings)
    is_done = pipeline.session.is_fresh("scan", {}, origin)
    store = ScanStore(pipeline.session.path / UNFINISHED_SCAN, origin)
    if request.restart or is_replay:  # playing a recording again costs nothing
        store.remove()
    if is_done and not request.restart and not store.folder.exists():
        if not (request.adaptive or request.retake):
            return
        store.adopt(pipeline.session.folder("scan"))
    elif request.retake and not is_done:
        raise StageError("There is no finished scan of this cell and object to retake views of; scan first.")
    opened = _open(settings if observer is None else animated(settings), mesh, seed)
    with connected(opened, operator, pipeline.reporter) as cell:
        _take(pipeline, cell, store, request, observer, operator)
    pipeline.keep_written_scan(store.publish, origin)
    store.remove()


def _take(
    pipeline: Pipeline,
    cell: Cell,
    store: ScanStore,
    request: ScanRequest,
    observer: ScanObserver | None,
    operator: ScanOperator | None,
) -> None:
    from app.operations.calibration.reference import check_drift
    from hardware.pouring.run_log import RunLog

    reporter = pipeline.reporter
    with nullcontext() if observer is None else observer.opened(cell):
        if request.cell_file is not None and cell.settings.robot.kind != "replay":
            check_drift(cell, request.cell_file, reporter, operator)
        if operator is None or not cell.settings.robot.is_real:
            ScanRun(cell, store, reporter, observer).take(request)
            return
        with RunLog(_next_run_folder(pipeline.session.path)) as log:
            ScanRun(cell, store, reporter, observer, Watch(operator, log)).take(request)


def _next_run_folder(session: Path) -> Path:
    """For the log of the arm's motions; one each time that the devices are opened."""
    runs = session / SCAN_RUNS_FOLDER
    return runs / f"{len(list(runs.glob('[0-9]*'))) + 1:04d}"


def _open(settings: CellSettings, mesh: TriangleMesh | None, seed: int) -> Cell:
    from hardware.cell import open_cell
    from hardware.cell.scene import object_space
    from hardware.simulation.placing import world_with

    world = None if mesh is None else world_with(mesh, settings.place, seed, object_space(settings))
    return open_cell(settings, world, seed)


def propose_views(scan_folder: Path, settings: CellSettings, reporter: Reporter) -> Proposal:
    """Choose reachable views that would show more of what a finished scan left hidden; takes up to 15 s.

    Args:
        scan_folder: of the scan, taken in this cell.
        settings: the cell; nothing of it is connected.
        reporter: learns that views are being chosen.

    Raises:
        PoursightError: the scan cannot be read.
        Cancelled: on request.
    """
    from core.reconstruction.unseen import find_unseen_inside
    from core.scan import read_scan
    from hardware.scanning.next_best_views import STAGE, object_volume, propose
    from hardware.scanning.planning import cell_for_plan
    from hardware.scanning.store import read_plan

    reporter.progress(STAGE, 0, 1)
    scan, plan = read_scan(scan_folder, Reporter()), read_plan(scan_folder)
    cell = _unconnected(settings)
    cell = cell if plan is None else cell_for_plan(cell, plan)
    volume = object_volume(scan, reporter)
    if volume is None:
        return Proposal(0, 0.0)
    unseen = find_unseen_inside(volume, cell.settings.place.platform_height_m)
    proposals = propose(cell, scan, volume, unseen)
    return Proposal(len(proposals), sum(share for _, share in proposals))


def object_mesh(source: str, reporter: Reporter) -> TriangleMesh:
    """Return a built-in object by its name, or a mesh from its file.

    Raises:
        InputError: there is no such object, or the file cannot be used.
    """
    from core.mesh_file import read_mesh
    from hardware.simulation.objects import builtin_object

    if is_mesh_file(source):
        return read_mesh(Path(source), reporter)
    return builtin_object(source)


def is_mesh_file(source: str) -> bool:
    """Return whether an object is named by its file; otherwise it is a built-in one.

    Raises:
        InputError: there is neither; what is wrong with a file is not known before it is read.
    """
    from hardware.simulation.objects import BUILTIN_OBJECTS, builtin_object

    if source in BUILTIN_OBJECTS:
        return False
    path = Path(source)
    if is_file(path):
        return True
    if path.suffix or path.name != source:
        raise InputError(f"There is no mesh file {excerpt(source)}; check the name.")
    builtin_object(source)  # which says what there is
    return False


def _origin(
    settings: CellSettings, source: str | None, mesh: TriangleMesh | None, seed: int
) -> dict[str, Any]:
    """Which scan this is, as plain JSON: two scans of one origin in a simulated cell are the same."""
    origin: dict[str, Any] = {
        "cell": json.loads(settings.model_dump_json()),
        "table_height_m": settings.place.table_height_m,
    }
    if mesh is not None:
        content = mesh.vertices_m.tobytes() + mesh.faces.tobytes()
        origin |= {"object": source, "object_sha256": hashlib.sha256(content).hexdigest(), "seed": seed}
    return origin


def _known_camera_error(cell_file: Path, settings: CellSettings) -> dict[str, float]:
    """What the imagination reads of the camera's calibration; nothing if it was not calibrated here."""
    from app.operations.calibration.camera_error import camera_error
    from core.stages import CAMERA_ERRORS

    error = camera_error(cell_file, settings.camera.pose)
    return {} if error is None else dict(zip(CAMERA_ERRORS, error, strict=True))


def _unconnected(settings: CellSettings) -> Cell:
    """The cell with its arm and obstacles; a simulated one has nothing on its platform."""
    import numpy as np

    from hardware.cell import open_cell
    from hardware.simulation.world import World

    if not settings.has_simulated_object:
        return open_cell(settings)
    table_m = np.array([*settings.place.platform_center_m[:2], settings.place.table_height_m])
    return open_cell(settings, World(None, table_m))
