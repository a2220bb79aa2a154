"""The stage from a scan to the object's mesh (Sec. IV-A)."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from core.errors import StageError
from core.geometry import BoolArray
from core.mesh import TriangleMesh
from core.parameters.reconstruction import ReconstructionParameters
from core.progress import Reporter
from core.reconstruction.floor import SeenFloor, keep_floor, seen_floor
from core.reconstruction.fusion import FusedObject, fuse_object
from core.reconstruction.result import Reconstruction
from core.reconstruction.segmentation import Part, cut_at_height, cut_at_table, fill_unseen
from core.reconstruction.tsdf import DistanceGrid, TsdfVolume, extract_surface, largest_piece
from core.reconstruction.unseen import SMALLEST_UNSEEN_ML, UnseenInside, find_unseen_inside
from core.scan.model import Scan
from core.unseen_readings import UnseenReadings


def reconstruct(scan: Scan, parameters: ReconstructionParameters, reporter: Reporter) -> Reconstruction:
    """Fuse all views, cut the object out and close its surface.

    Raises:
        StageError: the crop box holds no object, or too many voxels.
        Cancelled: the user asked to stop.
    """
    fused = fuse_object(scan, parameters, reporter)
    field, readings = _object_field(fused, parameters), None
    if parameters.unseen == "solid":
        unseen = find_unseen_inside(fused.volume, fused.support_m)
        holes = field.free_down_to(fused.support_m, unseen.first_layer)
        field = field.freed(unseen.beside_holes(fused.volume, holes))
        readings = _unseen_readings(fused, field, unseen)
    mesh, truncation_m = field.surface(fused.support_m), fused.volume.truncation_m
    return Reconstruction(mesh, fused.support_m, truncation_m, fused.health, fused.refinement, readings)


def _unseen_readings(fused: FusedObject, solid: _ObjectField, unseen: UnseenInside) -> UnseenReadings | None:
    """What else the object may be, where views ended inside its openings; none if none could matter."""
    volume, support_m = fused.volume, fused.support_m
    room = unseen.room(volume.voxel_m)
    unseen_ml = float(room.sum() * volume.voxel_m**3 * 1e6)
    if unseen_ml < SMALLEST_UNSEEN_ML:
        return None
    roomy = solid.freed(unseen.in_volume(room)).surface(support_m)
    through = unseen.way_through(volume)
    return UnseenReadings(
        unseen_ml, roomy, None if through is None else solid.freed(through).surface(support_m)
    )


@dataclass(frozen=True)
class _ObjectField:
    """Distances (X, Y, Z) in the object's part of a volume, where what no view saw was given a value.

    Where a thin floor was made thick enough for the voxels, `floor` knows how high it was seen.
    """

    volume: TsdfVolume
    part: Part
    distance: DistanceGrid
    keeps_specks: bool
    floor: SeenFloor | None = None

    def free_down_to(self, support_m: float, layer: int) -> BoolArray:
        """Return (X, Y) which columns of the whole volume are free from a layer of it down to the support."""
        layers = np.arange(self.distance.shape[2]) + self.part.low[2]
        heights_m = self.volume.origin_m[2] + self.volume.voxel_m * layers
        below = self.distance[:, :, (layers <= layer) & (heights_m > support_m)]
        columns = np.zeros(self.volume.weight.shape[:2], dtype=np.bool_)
        columns[self.part.slices[:2]] = (below > 0).all(axis=2)
        return columns

    def freed(self, voxels: BoolArray) -> _ObjectField:
        """Take voxels (X, Y, Z) of the whole volume as free, whatever they were."""
        return replace(self, distance=np.where(voxels[self.part.slices], np.float32(1.0), self.distance))

    def surface(self, support_m: float) -> TriangleMesh:
        """Return the surface.

        Raises:
            StageError: nothing is above the platform.
        """
        origin_m = self.volume.centers_m(self.part.low)
        mesh = extract_surface(self.distance, origin_m, self.volume.voxel_m)
        if len(mesh.faces) == 0:
            raise StageError(
                f"Nothing of the object lies above the platform at {support_m * 1000:.0f} mm; its surface "
                f"ends at {self.volume.centers_m(self.part.seen.max(axis=0))[2] * 1000:.0f} mm, so correct "
                "reconstruction.platform_height_m."
            )
        piece = mesh if self.keeps_specks else largest_piece(mesh)
        return piece if self.floor is None else self.floor.lowered(piece)


def _object_field(fused: FusedObject, parameters: ReconstructionParameters) -> _ObjectField:
    volume, table, support_m = fused.volume, fused.table, fused.support_m
    solid = parameters.unseen == "solid"
    # The released code keeps the specks beside the object, which lie within the cluster's gap.
    keeps_specks = not solid and table is None
    part = fused.part if keeps_specks else fused.down_to_support()
    distance = fill_unseen(volume, part) if solid else volume.distance[part.slices]
    floor = None
    if table is not None:
        distance = cut_at_table(distance, volume, part, table, parameters.plane_margin_m)
    elif solid:
        error_m = volume.falloff_m if np.isfinite(volume.falloff_m) else volume.voxel_m
        floor = seen_floor(volume, part, support_m, error_m)
        distance = keep_floor(distance, volume, part, support_m, error_m)
        distance = cut_at_height(distance, volume, part, support_m)
    return _ObjectField(volume, part, distance, keeps_specks, floor)
