"""What the pictures of a comparison show of a session, read in a thread. No Qt here."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from app.gui.pages.photographed import in_colors
from app.gui.pages.pour_cells import pour_cells
from app.gui.views.scene.occlusion import surface_points_m
from app.gui.views.scene.parts import PreparedMesh, prepare_mesh
from core.errors import PoursightError
from core.geometry import FloatArray
from core.mesh_file import read_ply
from core.pipeline.session_view import SessionView

if TYPE_CHECKING:
    from app.gui.views.pour_map import MappedPour

_N_CASTERS = 15_000


@dataclass(frozen=True, eq=False)
class ComparedModel:
    """A session's surface and pours.

    Attributes:
        folder: the session's.
        body: the surface, its middle over the origin and its lowest point at height 0, so that two of them
            can be seen from the same place; none if there is none.
        casters_m: (N, 3) points all over it, for its shadow.
        extents_m: (3,) its size; zeros without one.
        cells: the imagined pours; empty if there are none.
        chosen: (i, j) of the pour that was or would be made.
        problem: why there is nothing to see; empty if there is.
    """

    folder: Path
    body: PreparedMesh | None
    casters_m: FloatArray
    extents_m: FloatArray
    cells: tuple[MappedPour, ...] = ()
    chosen: tuple[int, int] | None = None
    problem: str = ""


def read_compared(folder: Path) -> ComparedModel:
    """Read what there is; what cannot be read is said in the place of the model."""
    try:
        return _read(SessionView.of(folder))
    except PoursightError as error:
        return ComparedModel(folder, None, np.empty((0, 3)), np.zeros(3), problem=str(error))


def _read(view: SessionView) -> ComparedModel:
    folder, motions, grid = view.session.path, view.motions, view.grid
    risk = None if view.tries is None else view.tries.risk
    if motions is not None and motions.risk is not None:
        risk = motions.risk
    cells = () if grid is None else tuple(pour_cells(grid, risk, motions))
    if view.source not in view.records:
        return ComparedModel(folder, None, np.empty((0, 3)), np.zeros(3), cells, view.place)
    mesh = read_ply(view.session.folder(view.source) / "mesh.ply")
    low, high = mesh.aabb_min_m, mesh.aabb_max_m
    vertices_m = mesh.vertices_m - [*(low + high)[:2] / 2, low[2]]
    body = in_colors(prepare_mesh(vertices_m, mesh.faces, is_shaded=True), mesh, view)
    casters_m = surface_points_m(vertices_m, mesh.faces, _N_CASTERS)
    return ComparedModel(folder, body, casters_m, high - low, cells, view.place)
