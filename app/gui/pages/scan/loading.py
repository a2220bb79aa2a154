"""What the page shows of the session and the cell, read in the background. Knows no Qt."""

from __future__ import annotations

import json
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from app.gui.views.scene.parts import PreparedMesh, prepare_mesh
from app.jobs.scan_events import ViewProgress
from app.jobs.scan_work import planned_pose
from app.library.session_folder import UNFINISHED_SCAN
from core.errors import PoursightError
from core.session import Session

if TYPE_CHECKING:
    import numpy.typing as npt

    from core.geometry import FloatArray
    from core.mesh import TriangleMesh
    from core.quality.measures import ScanQuality
    from core.reconstruction.result import Reconstruction
    from core.scan.model import CropBox
    from hardware.cell import CellSettings
    from hardware.scanning.views import ViewRecord

Source = Literal["nothing", "interrupted", "scan", "mesh"]
"""Nothing yet; views of an interrupted scan; a finished scan; an imported mesh."""
COLOR_ENDING, DEPTH_ENDING, POSE_ENDING = ".color.png", ".depth.png", ".pose.txt"
FRAMES = "rgbd"


@dataclass(frozen=True)
class Picture:
    """A view's images on the disk; another one when they were taken again.

    Attributes:
        color: the colour image's file.
        stamp_ns: when it was written.
    """

    color: Path
    stamp_ns: int

    @property
    def depth(self) -> Path:
        """The depth image's file."""
        return self.color.with_name(self.color.name.removesuffix(COLOR_ENDING) + DEPTH_ENDING)


@dataclass(frozen=True, eq=False)
class ScanContents:
    """What a session holds of a scan.

    Attributes:
        source: what is there.
        views: in their order, planned ones among them.
        pictures: of those that have images, by name.
        object_name: of what is scanned in a simulated cell, or its mesh file; none in other cells.
        box: that the scan's plan laid around the object; none: the cell's.
        is_of_cell: whether the chosen cell can take further views of it.
        quality: how good the scan is; none before it was checked.
        pose_error_m: how far a view's surface errs, poses corrected as far as they were; none if not known.
        mesh: the surface, ready to be drawn; none before there is one.
        extents_m: (3,) the surface's size along the axes.
    """

    source: Source
    views: tuple[ViewProgress, ...] = ()
    pictures: dict[str, Picture] | None = None
    object_name: str | None = None
    box: CropBox | None = None
    is_of_cell: bool = False
    quality: ScanQuality | None = None
    pose_error_m: float | None = None
    mesh: PreparedMesh | None = None
    extents_m: FloatArray | None = None

    @property
    def n_taken(self) -> int:
        """How many views have images."""
        return sum(view.state in ("taken", "poor") for view in self.views)


@dataclass(frozen=True, eq=False)
class ScanKey:
    """What is to be read, at every refresh: views are added without a new stage.

    Attributes:
        session: the open one.
        cell: that is worked with.
        seed: of the parameters; a simulated scan goes on with its own seed only.
    """

    session: Session | None
    cell: CellSettings | None
    seed: int


def load_scan(key: ScanKey) -> ScanContents:
    """Read everything the page shows of a session.

    Raises:
        PoursightError: a file is damaged.
    """
    from hardware.scanning.store import read_origin, read_views

    session, cell, seed = key.session, key.cell, key.seed
    if session is None:
        return _planned(cell)
    if session.record("mesh") is not None:
        return _imported_mesh(session)
    folder = session.path / UNFINISHED_SCAN
    if read_views(folder):
        return _views(folder, "interrupted", cell, read_origin(folder), seed)
    record = session.record("scan")
    if record is None:
        return _planned(cell)
    return _with_results(session, _views(session.path / "scan", "scan", cell, record.parameters, seed))


def load_images(picture: Picture) -> tuple[npt.NDArray[np.uint8], npt.NDArray[np.float32]]:
    """Read a view's colour (H, W, 3) and depth (H, W) in metres.

    Raises:
        InputError: a file is missing or damaged.
    """
    from core.scan.view_files import read_color, read_depth

    return read_color(picture.color), read_depth(picture.depth)


def object_names() -> tuple[str, ...]:
    """Return the built-in objects of the simulated cell."""
    from hardware.simulation.objects import BUILTIN_OBJECTS

    return tuple(BUILTIN_OBJECTS)


def object_title(source: str) -> str:
    """Return what people call an object: a built-in one by its name, a mesh by its file's name."""
    path = Path(source)
    return path.name if path.suffix else source.capitalize()


def _planned(cell: CellSettings | None) -> ScanContents:
    """What the cell will do; the views of a recorded scan are known when it is played."""
    from hardware.scanning.views import name_views

    if cell is None or cell.camera.kind == "replay":
        return ScanContents("nothing")
    views = name_views(cell.scan.views_rad)
    return ScanContents(
        "nothing",
        tuple(ViewProgress(v.name, "pending", (), planned_pose(cell, v.joints_rad)) for v in views),
    )


def _imported_mesh(session: Session) -> ScanContents:
    from core.mesh_file import read_ply

    mesh = read_ply(session.folder("mesh") / "mesh.ply")
    return ScanContents("mesh", mesh=_prepared(mesh), extents_m=mesh.extents_m)


def _views(
    folder: Path, source: Source, cell: CellSettings | None, origin: dict[str, Any], seed: int
) -> ScanContents:
    from hardware.scanning.store import read_plan, read_views

    records, plan = read_views(folder), read_plan(folder)
    frames = folder / FRAMES
    if records:
        views = [_view(record, frames, cell) for record in records]
    else:  # imported: what became of each view was not recorded
        names = sorted(path.name.removesuffix(COLOR_ENDING) for path in frames.glob("*" + COLOR_ENDING))
        views = [ViewProgress(name, "taken", (), _kept_pose(frames, name)) for name in names]
    named = origin.get("object")
    return ScanContents(
        source,
        tuple(views),
        {path.name.removesuffix(COLOR_ENDING): _picture(path) for path in frames.glob("*" + COLOR_ENDING)},
        object_name=str(named) if named is not None else None,
        box=None if plan is None else plan.crop_box,
        is_of_cell=cell is not None and _is_of_cell(origin, cell, seed),
    )


def _is_of_cell(origin: dict[str, Any], cell: CellSettings, seed: int) -> bool:
    is_recorded = cell.camera.kind == "replay"
    same_cell = origin.get("cell") == json.loads(cell.model_dump_json())
    return same_cell and origin.get("seed", seed) == seed and not is_recorded


def _view(record: ViewRecord, frames: Path, cell: CellSettings | None) -> ViewProgress:
    pose = _kept_pose(frames, record.view.name) if record.has_image else None
    if pose is None and cell is not None and any(record.view.joints_rad):
        pose = planned_pose(cell, record.view.joints_rad)
    return ViewProgress(record.view.name, record.state.value, record.problems, pose)


def _kept_pose(frames: Path, name: str) -> FloatArray | None:
    from core.scan.view_files import read_pose

    try:
        return read_pose(frames / (name + POSE_ENDING))
    except PoursightError:
        return None  # the view is shown without its place


def _picture(path: Path) -> Picture:
    return Picture(path, path.stat().st_mtime_ns)


def _with_results(session: Session, contents: ScanContents) -> ScanContents:
    """Add what was made from the scan, as far as it is there."""
    from core.quality.measures import ScanQuality
    from core.reconstruction.result import Reconstruction

    if session.record("quality") is not None:
        quality = ScanQuality.load(session.folder("quality"))
        contents = replace(contents, quality=quality, views=_with_problems(contents.views, quality))
    if session.record("reconstruction") is not None:
        model = Reconstruction.load(session.folder("reconstruction"))
        contents = replace(
            contents,
            mesh=_prepared(model.mesh),
            extents_m=model.mesh.extents_m,
            pose_error_m=_pose_error_m(model),
        )
    return contents


def _with_problems(views: tuple[ViewProgress, ...], quality: ScanQuality) -> tuple[ViewProgress, ...]:
    """An imported view has the problems that the judgement found."""
    found = {view.name: view.problems for view in quality.views if view.problems}
    return tuple(
        ViewProgress(view.name, "poor", found[view.name], view.T_base_camera)
        if view.state == "taken" and view.name in found
        else view
        for view in views
    )


def _pose_error_m(model: Reconstruction) -> float | None:
    if model.refinement is not None:
        return model.refinement.view_error_m
    return model.pose_health.sd_height_m


def _prepared(mesh: TriangleMesh) -> PreparedMesh:
    return prepare_mesh(mesh.vertices_m, mesh.faces)
