"""The robot's scan of a cell, kept in a session."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Callable
from contextlib import AbstractContextManager, nullcontext
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from core.errors import InputError, StageError
from core.progress import Reporter

if TYPE_CHECKING:
    from core.mesh import TriangleMesh
    from core.pipeline.pipeline import Pipeline
    from hardware.cell import Cell, CellSettings
    from hardware.scanning.control import ScanControl
    from hardware.scanning.keeping import ScanKeeper
    from hardware.scanning.procedure import ViewsPlanned, ViewTaken

IN_PROGRESS = "scan-in-progress"
"""The session's folder for views of a scan that is not finished."""
_SEEN_SPEED_UP = 5.0
"""Who watches a simulated scan wants to see the arm move, but not for a minute."""


@dataclass(frozen=True)
class ScanWishes:
    """What the user asked for beyond the scan itself.

    Attributes:
        adaptive: look again where the inside of an opening was not seen.
        retake: names of views of the finished scan to take again.
        restart: throw away what an interrupted scan left.
    """

    adaptive: bool = False
    retake: tuple[str, ...] = ()
    restart: bool = False


@dataclass(frozen=True)
class ScanWatch:
    """How somebody follows a scan while it is made.

    Attributes:
        control: pauses it.
        opened: given the cell; what it returns is entered while the cell's devices are connected.
        planned: told what `ScanProcedure` plans.
        taken: told of each view.
    """

    control: ScanControl
    opened: Callable[[Cell], AbstractContextManager[object]]
    planned: ViewsPlanned
    taken: ViewTaken


def scan_object(
    pipeline: Pipeline,
    settings: CellSettings,
    source: str | None,
    wishes: ScanWishes = ScanWishes(),
    watch: ScanWatch | None = None,
) -> None:
    """Scan in a cell, continuing what was interrupted; nothing is done when the session holds this very scan.

    Args:
        pipeline: of the session; its seed is that of a simulated cell.
        settings: the cell.
        source: for a simulated cell, a built-in object's name or a mesh file.
        wishes: what to do beyond that.
        watch: of whoever follows it; a simulated arm then moves where it would jump.

    Raises:
        PoursightError: the sentence says what is in the way; every view that was taken is kept.
    """
    from hardware.scanning.keeping import ScanKeeper

    is_replay = settings.camera.kind == "replay"
    if is_replay and (wishes.adaptive or wishes.retake):
        raise InputError("A recorded scan cannot be taken again; leave out --adaptive and --retake.")
    mesh = object_mesh(source, pipeline.reporter) if source is not None else None
    seed = pipeline.parameters.seed
    origin = _origin(settings, source, mesh, seed)
    is_done = pipeline.session.is_fresh("scan", {}, origin)
    keeper = ScanKeeper(pipeline.session.path / IN_PROGRESS, origin)
    if wishes.restart or is_replay:  # playing a recording anew costs nothing
        keeper.remove()
    if is_done and not wishes.restart and not keeper.folder.exists():
        if not (wishes.adaptive or wishes.retake):
            return
        keeper.adopt(pipeline.session.folder("scan"))
    elif wishes.retake and not is_done:
        raise StageError("There is no finished scan of this cell and object to retake views of; scan first.")
    _take(pipeline, settings, mesh, seed, keeper, wishes, watch)
    pipeline.keep_written_scan(keeper.publish, origin)
    keeper.remove()


def _take(
    pipeline: Pipeline,
    settings: CellSettings,
    mesh: TriangleMesh | None,
    seed: int,
    keeper: ScanKeeper,
    wishes: ScanWishes,
    watch: ScanWatch | None,
) -> None:
    from hardware.scanning.looking_again import look_again
    from hardware.scanning.procedure import ScanProcedure
    from hardware.scanning.views import name_views

    with (
        _open(settings if watch is None else _moving(settings), mesh, seed) as cell,
        nullcontext() if watch is None else watch.opened(cell),
    ):
        followed = () if watch is None else (watch.control, watch.taken, watch.planned)
        procedure = ScanProcedure(cell, keeper, pipeline.reporter, *followed)
        procedure.take(name_views(cell.views_rad))
        procedure.retake(wishes.retake)
        if wishes.adaptive:
            look_again(cell, procedure)
        procedure.scan()  # refuses what is too little to be kept as a scan


def _open(settings: CellSettings, mesh: TriangleMesh | None, seed: int) -> Cell:
    from hardware.cell import open_cell
    from hardware.simulation.placing import world_with

    world = None if mesh is None else world_with(mesh, settings.place, seed)
    return open_cell(settings, world, seed)


def _moving(settings: CellSettings) -> CellSettings:
    """The same cell, with a simulated arm that moves where it would jump; its images are the same.

    As if time ran faster: speeds grow with the factor, accelerations with its square.
    """
    if not (settings.is_simulated and settings.simulation.is_instant):
        return settings
    robot, factor = settings.robot, _SEEN_SPEED_UP
    faster = {
        "joint_speed_rad_s": factor * robot.joint_speed_rad_s,
        "joint_acceleration_rad_s2": factor**2 * robot.joint_acceleration_rad_s2,
    }
    return settings.model_copy(
        update={
            "robot": robot.model_copy(update=faster),
            "scan": settings.scan.model_copy(update={"settle_s": 0.0}),
            "simulation": settings.simulation.model_copy(update={"is_instant": False}),
        }
    )


def object_mesh(source: str, reporter: Reporter) -> TriangleMesh:
    """Return a built-in object by its name, or a mesh from its file.

    Raises:
        InputError: there is no such object, or the file cannot be used.
    """
    from core.mesh_file import read_mesh
    from hardware.simulation.objects import BUILTIN_OBJECTS, builtin_object

    path = Path(source)
    if source in BUILTIN_OBJECTS or not (path.suffix or path.exists()):
        return builtin_object(source)
    return read_mesh(path, reporter)


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
