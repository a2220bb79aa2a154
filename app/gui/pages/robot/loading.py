"""What the page shows of the cell and the session, read in the background. Knows no Qt."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from app.gui.pages.cell_model import CellModel, cell_model
from app.gui.pages.photographed import in_colors
from app.gui.views.scene.parts import PreparedMesh, prepare_mesh
from app.gui.views.scene.shapes import box_mesh
from core.geometry import FloatArray
from core.pipeline.session_view import SessionView
from core.session.pour_runs import PourRun, pour_runs

if TYPE_CHECKING:
    from core.parameters.bodies import CupParameters
    from hardware.cell.settings import CellSettings

_AROUND_M = 0.15
_HIGH_M = 0.75
"""So far above the table the arm is seen."""


@dataclass(frozen=True, eq=False)
class RobotCell:
    """What is shown of a cell.

    Attributes:
        model: arm and furniture.
        cup: the cup's surface in its own frame.
        station_m: (3,) the middle of the standing cup's foot.
        corners_m: (N, 3) of the box that is kept in view, wherever in it the arm is.
    """

    model: CellModel
    cup: PreparedMesh
    station_m: FloatArray
    corners_m: FloatArray


@dataclass(frozen=True)
class SessionPours:
    """What a session says about its pours.

    Attributes:
        is_container: whether the object is an open container; none if that was not imagined.
        chosen: the pour (i, j) that a plan would take; none if that is not known yet.
        runs: that were made, the oldest first.
    """

    is_container: bool | None
    chosen: tuple[int, int] | None
    runs: tuple[PourRun, ...]


def load_cell(cell: CellSettings, cup: CupParameters) -> RobotCell:
    """Put the cell together."""
    from core.imagination.rendering.shapes import cup_surface

    station_m = np.array(cell.place.cup_station_m)
    model, surface = cell_model(cell, [station_m[:2]], _AROUND_M), cup_surface(cup)
    low_m, high_m = model.table[0].min(axis=0)[:2], model.table[0].max(axis=0)[:2]
    top_m = cell.place.table_height_m
    return RobotCell(
        model,
        prepare_mesh(surface.vertices_m, surface.faces),
        station_m,
        box_mesh((*low_m, top_m), (*high_m, top_m + _HIGH_M))[0],
    )


def load_object(folder: Path) -> PreparedMesh | None:
    """Read the object's surface; none if it was not reconstructed."""
    from core.mesh_file import read_ply

    path = folder / "reconstruction" / "mesh.ply"
    if not path.is_file():
        return None
    mesh = read_ply(path)
    body = prepare_mesh(mesh.vertices_m, mesh.faces, is_shaded=True)
    return in_colors(body, mesh, SessionView.of(folder))


def load_session_pours(folder: Path) -> SessionPours:
    """Read what was imagined and what was poured.

    Raises:
        SessionError: a file is damaged.
    """
    view = SessionView.of(folder)
    verdict, pours, chosen = view.verdict, view.pours, None
    if pours is not None and (view.operator is not None or view.motions is not None):
        chosen = view.place
    is_container = None if verdict is None else verdict.is_open_container
    return SessionPours(is_container, chosen, tuple(pour_runs(folder)))
