"""What the page shows of the cell and the session, read and put together in the background. Knows no Qt."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from app.gui.views.scene.prepared import PreparedMesh, prepare_mesh
from app.gui.views.scene.shapes import Shape, box_mesh
from core.files import read_json
from core.geometry import FloatArray
from core.session import Session
from core.session.operator_choice import read_operator_choice
from core.session.pour_runs import PourRun, pour_runs

if TYPE_CHECKING:
    from core.motion.arm_models import ArmModel
    from core.motion.arm_shape import Capsule
    from core.parameters.imagination import CupParameters
    from hardware.cell.settings import CellSettings

_AROUND_M = 0.15
"""How far the table is shown beyond what stands on it; where it really ends is nobody's concern."""
_TABLE_M = 0.03
_FOOT_M = 0.12
"""About the robot's foot."""
_HIGH_M = 0.75
"""So far above the table the arm is seen."""


@dataclass(frozen=True, eq=False)
class ShownCell:
    """What stands in a cell.

    Attributes:
        arm: its model.
        tools: on its flange.
        home_rad: (6,) where it rests.
        table: the part of it that is of interest.
        platform: where the object stands.
        obstacles: further things to keep away from.
        cup: the cup's surface in its own frame.
        station_m: (3,) the middle of the standing cup's foot.
        room_m: (N, 3) corners of the room that is to be seen, wherever the arm is in it.
    """

    arm: ArmModel
    tools: tuple[Capsule, ...]
    home_rad: FloatArray
    table: Shape
    platform: Shape
    obstacles: tuple[Shape, ...]
    cup: PreparedMesh
    station_m: FloatArray
    room_m: FloatArray


@dataclass(frozen=True)
class Standing:
    """What a session says about its pours.

    Attributes:
        is_container: whether the object is an open container; none if that was not imagined.
        chosen: the pour (i, j) that a plan would take; none if nobody knows yet.
        runs: that were made, the oldest first.
    """

    is_container: bool | None
    chosen: tuple[int, int] | None
    runs: tuple[PourRun, ...]


def load_cell(cell: CellSettings, cup: CupParameters) -> ShownCell:
    """Put the cell together."""
    from core.imagination.rendering.shapes import cup_surface
    from hardware.cell.scene import pour_cell

    place, known = cell.place, pour_cell(cell)
    low, high = np.array(place.platform_min_m), np.array(place.platform_max_m)
    top, station = place.table_height_m, np.array(place.cup_station_m)
    corners = np.array([low, high, station[:2], [-_FOOT_M] * 2, [_FOOT_M] * 2])
    low_m, high_m = corners.min(axis=0) - _AROUND_M, corners.max(axis=0) + _AROUND_M
    surface = cup_surface(cup)
    return ShownCell(
        known.arm,
        known.tools,
        known.home_rad,
        box_mesh((*low_m, top - _TABLE_M), (*high_m, top)),
        box_mesh((*low, top), (*high, place.platform_height_m)),
        tuple(box_mesh(box.min_m, box.max_m) for box in cell.obstacles),
        prepare_mesh(surface.vertices_m, surface.faces),
        station,
        box_mesh((*low_m, top), (*high_m, top + _HIGH_M))[0],
    )


def load_object(folder: Path) -> PreparedMesh | None:
    """Read the object's surface; none if it was not reconstructed."""
    from core.ply import read_ply

    path = folder / "reconstruction" / "mesh.ply"
    if not path.is_file():
        return None
    mesh = read_ply(path)
    return prepare_mesh(mesh.vertices_m, mesh.faces)


def load_standing(folder: Path) -> Standing:
    """Read what was imagined and what was poured."""
    from core.motion.pour.choosing import PourMotions

    session = Session.open(folder)
    record = session.record("pouring")
    is_container = None
    if session.record("containability") is not None:
        found = read_json(session.folder("containability") / "containability.json")
        is_container = bool(found["is_open_container"])
    operator = None if record is None else read_operator_choice(folder, record.digest)
    chosen = None if operator is None else (operator.i, operator.j)
    if chosen is None and session.record("motion") is not None:
        choice = PourMotions.load(session.folder("motion")).choice
        chosen = None if choice is None else (choice.i, choice.j)
    return Standing(is_container, chosen, tuple(pour_runs(folder)))
