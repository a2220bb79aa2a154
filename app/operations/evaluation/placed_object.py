"""An object placed on the platform, and what the program knows of it: its mesh, or a scan."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np

from core.geometry import make_pose
from core.mesh import TriangleMesh
from core.mesh_file import read_mesh
from core.parameters import Parameters
from core.pipeline.given_mesh import GivenMesh
from core.progress import Reporter
from core.reconstruction.result import Reconstruction
from core.reconstruction.stage import reconstruct
from core.scan.model import Scan
from core.scratch import ScratchFolder
from hardware.cell.scene import object_space
from hardware.cell.settings import CellSettings, PlaceSettings
from hardware.scanning.simulated import simulate_scan, simulated_cell
from hardware.simulation.placing import WALL_MARGIN_M, place_on_platform, transform_mesh
from hardware.simulation.pour_outcome.bodies import PlatformBox

Input = Literal["mesh", "scan"]
_SLACK_M = 0.01
"""Space in the crop box beyond what the object needs at its best angle."""


@dataclass(frozen=True)
class PlacedObject:
    """An object in the base frame.

    Attributes:
        true: its true mesh where it is placed.
        place: platform and table of the simulated cell.
    """

    true: TriangleMesh
    place: PlaceSettings

    @property
    def platform(self) -> PlatformBox:
        """What carries it."""
        place = self.place
        return PlatformBox(place.platform_min_m, place.platform_max_m, place.platform_height_m)


def mesh_of_content(content: bytes, ending: str) -> TriangleMesh:
    """Read a mesh from the content of its file, which may come from another machine.

    Raises:
        InputError: the content cannot be used.
    """
    with ScratchFolder() as folder:
        path = folder / f"object{ending}"
        path.write_bytes(content)
        return read_mesh(path, Reporter())


def place_object(mesh: TriangleMesh, source: Input, seed: int) -> PlacedObject:
    """Put an object on the simulated cell's platform: at random to be scanned, else in its middle as it is.

    Raises:
        InputError: the object does not fit into the crop box.
    """
    cell = cell_for(mesh)
    place = cell.place
    if source == "scan":
        pose = place_on_platform(mesh, seed, place, object_space(cell))
        return PlacedObject(transform_mesh(mesh, pose), place)
    middle = (mesh.aabb_min_m + mesh.aabb_max_m) / 2
    foot = np.array([*middle[:2], mesh.aabb_min_m[2]])
    return PlacedObject(transform_mesh(mesh, make_pose(np.eye(3), place.platform_center_m - foot)), place)


def cell_for(mesh: TriangleMesh) -> CellSettings:
    """Return the simulated cell, its crop box enlarged as an operator would for an object that is too large.

    It is enlarged upwards and along x, where the arm has clearance; along y it has none. Views are planned
    for an object whose box the arm cannot keep clear of in the cell's own.
    """
    cell = simulated_cell()
    place = cell.place
    low, high = np.array(place.crop_min_m), np.array(place.crop_max_m)
    clearance_m = 2 * (WALL_MARGIN_M + _SLACK_M)
    missing_x_m = max(float(mesh.extents_m[:2].max()) + clearance_m - (high[0] - low[0]), 0.0)
    high[2] = max(high[2], place.platform_height_m + mesh.extents_m[2] + clearance_m)
    low[0], high[0] = low[0] - missing_x_m / 2, high[0] + missing_x_m / 2
    box = {"crop_min_m": tuple(low.tolist()), "crop_max_m": tuple(high.tolist())}
    return cell.model_copy(update={"place": place.model_copy(update=box)})


def known_surface(
    mesh: TriangleMesh, placed: PlacedObject, source: Input, parameters: Parameters, reporter: Reporter
) -> Reconstruction | GivenMesh:
    """Return what the program knows of a placed object: scanned with noise and pose errors, or its mesh.

    Args:
        mesh: the object in its own frame, as it was given to `place_object`.
        placed: what `place_object` made of it.
        source: whether it is scanned.
        parameters: of the reconstruction; the seed is that of the scan.
        reporter: receives the progress.

    Raises:
        PoursightError: it cannot be scanned or reconstructed.
    """
    if source == "mesh":
        return GivenMesh(placed.true)
    scan = take_scan(mesh, parameters.seed, reporter, is_lit=False)
    return reconstruct(scan, parameters.reconstruction, reporter)


def take_scan(mesh: TriangleMesh, seed: int, reporter: Reporter, *, is_lit: bool) -> Scan:
    """Scan an object, as `place_object` puts it there with the same seed, with noise and pose errors.

    Without light its colour images are black, and its depth images the same.

    Raises:
        PoursightError: it cannot be scanned.
    """
    return simulate_scan(mesh, seed, reporter, cell=cell_for(mesh), is_lit=is_lit)
