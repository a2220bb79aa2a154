"""Truncated signed distance volume, fused view by view (Curless & Levoy 1996; Sec. IV-A).

The arithmetic is the released code's, in single precision and in its order, so that the result agrees with
theirs to rounding.
"""

from __future__ import annotations

from itertools import pairwise

import numba
import numpy as np
import numpy.typing as npt
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components
from skimage.measure import marching_cubes

from core.errors import StageError
from core.geometry import BoolArray, FloatArray, IntArray
from core.mesh import TriangleMesh
from core.scan.model import DepthImage, Intrinsics, RgbdFrame
from core.threads import in_threads

DistanceGrid = npt.NDArray[np.float32]

MOST_VOXELS = 200_000_000
"""About 2.2 GB of volume; what comes after needs as much again."""
SMALLEST_DEPTH_M = 1e-4
LEAST_FREE_WEIGHT = np.float32(0.1)
"""Of a view far in front of a surface, with a falloff: free space must still carve."""
FAR_IN_FRONT = np.float32(np.sqrt(-np.log(LEAST_FREE_WEIGHT)))
"""In falloffs, where the weight has fallen to it."""
BEHIND_GAIN = np.float32(2.0)
"""With a falloff: how much more a view counts just behind its surface than just in front of it. A wall
thinner than the views are exact is "solid" from one side and "free" from the other: with equal weights it
would be full of holes."""
BEHIND_FASTER = np.float32(1.4)
"""And how much faster that falls behind than in front, so that nothing becomes thicker than it must."""
SURFACE_BAND = 0.2
"""Share of the truncation within which an observed voxel counts as surface (released code)."""
SLABS = 8
"""Parts of a volume that threads fuse: a few for each processor, for the views see some more than others."""


class TsdfVolume:
    """A grid of signed distances, in units of the truncation, positive outside.

    Voxel (i, j, k) has its centre at `origin_m + voxel_m * (i, j, k)` in the base frame.

    Attributes:
        distance: (X, Y, Z) float32 in [-1, 1]; 1 where nothing was fused yet.
        evidence: (X, Y, Z) float32, sum of the weights with which views count in `distance`.
        weight: (X, Y, Z) uint16, in how many views the voxel was seen (in front of the surface or within
            `behind_m` behind it).
        hidden: (X, Y, Z) bool, True where some view measured a surface in front of the voxel and farther than
            `behind_m`.
    """

    def __init__(
        self,
        crop_min_m: npt.ArrayLike,
        crop_max_m: npt.ArrayLike,
        voxel_m: float,
        truncation_m: float,
        behind_m: float | None = None,
        falloff_m: float = np.inf,
    ) -> None:
        """Start empty.

        Args:
            crop_min_m: lower corner (3,) in the base frame.
            crop_max_m: upper corner (3,).
            voxel_m: edge of a voxel.
            truncation_m: distance in front of a surface beyond which it does not matter.
            behind_m: how far behind a surface a view counts; by default the truncation.
            falloff_m: distance from a surface at which a view's weight has fallen to 1/e; by default never.
        """
        self.origin_m: FloatArray = np.asarray(crop_min_m, dtype=float)
        self.voxel_m = voxel_m
        self.truncation_m = truncation_m
        self.behind_m = truncation_m if behind_m is None else behind_m
        self.falloff_m = falloff_m
        size_m = np.asarray(crop_max_m, dtype=float) - self.origin_m
        shape = np.floor(size_m / voxel_m + 1e-6).astype(int)
        if np.prod(shape, dtype=float) > MOST_VOXELS:
            raise StageError(
                f"The crop box holds {np.prod(shape, dtype=float) / 1e6:.0f} million voxels of "
                f"{voxel_m * 1000:g} mm, more than {MOST_VOXELS // 1_000_000} million; "
                "enlarge reconstruction.voxel_m or shrink the crop box."
            )
        self.distance: DistanceGrid = np.ones(shape, dtype=np.float32)
        self.evidence: DistanceGrid = np.zeros(shape, dtype=np.float32)
        self.weight: npt.NDArray[np.uint16] = np.zeros(shape, dtype=np.uint16)
        self.hidden: BoolArray = np.zeros(shape, dtype=np.bool_)

    def integrate(
        self, frame: RgbdFrame, intrinsics: Intrinsics, max_depth_m: float, facing: DepthImage | None = None
    ) -> None:
        """Fuse one view; depth beyond `max_depth_m` is ignored.

        `facing` (H, W) turns a difference in depth into a distance along the surface's normal and weighs the
        view: 1 where a surface is seen straight on. Without it all pixels count as if they were.
        """
        depth_m = np.ascontiguousarray(frame.depth_m, dtype=np.float32)
        facing = np.ones_like(depth_m) if facing is None else facing
        one = np.float32(1)
        behind = (BEHIND_GAIN, BEHIND_FASTER) if np.isfinite(self.falloff_m) else (one, one)

        grids = self.distance, self.evidence, self.weight, self.hidden
        view = (
            self.origin_m.astype(np.float32),
            np.float32(self.voxel_m),
            np.float32(self.truncation_m),
            np.float32(self.behind_m),
            np.float32(self.falloff_m),
            *behind,
            depth_m,
            facing,
            intrinsics.matrix.astype(np.float32),
            np.ascontiguousarray(frame.T_base_camera, dtype=np.float32),
            np.float32(max_depth_m),
        )

        def fuse(slab: tuple[int, int]) -> None:
            _integrate(*grids, *slab, *view)

        # No voxel asks another one, so that the result does not depend on the number of threads.
        borders = np.linspace(0, len(self.distance), SLABS + 1).astype(int).tolist()
        in_threads(fuse, pairwise(borders))

    def mesh(self) -> TriangleMesh:
        """Everything fused so far as a closed surface in the base frame; empty before anything was seen."""
        return extract_surface(self.distance, self.origin_m, self.voxel_m)

    def surface_voxels(self) -> IntArray:
        """Indices (N, 3) of the voxels that were seen and lie next to the surface."""
        return np.argwhere((np.abs(self.distance) < np.float32(SURFACE_BAND)) & (self.weight > 0))

    def centers_m(self, indices: IntArray) -> FloatArray:
        """Voxel centres (N, 3) in the base frame of indices (N, 3)."""
        return self.origin_m + self.voxel_m * indices


@numba.njit(cache=True, nogil=True)  # type: ignore[untyped-decorator]
def _integrate(
    distance: DistanceGrid,
    evidence: DistanceGrid,
    weight: npt.NDArray[np.uint16],
    hidden: BoolArray,
    first: int,
    end: int,
    origin_m: npt.NDArray[np.float32],
    voxel_m: np.float32,
    truncation_m: np.float32,
    behind_m: np.float32,
    falloff_m: np.float32,
    behind_gain: np.float32,
    behind_faster: np.float32,
    depth_m: DepthImage,
    facing: DepthImage,
    camera: npt.NDArray[np.float32],
    pose: npt.NDArray[np.float32],
    max_depth_m: np.float32,
) -> None:
    """Fuse one view in place, in the layers from `first` to before `end` of the first axis."""
    height, width = depth_m.shape
    one = np.float32(1.0)
    for i in range(first, end):
        x = (origin_m[0] + np.float32(i) * voxel_m) - pose[0, 3]
        for j in range(distance.shape[1]):
            y = (origin_m[1] + np.float32(j) * voxel_m) - pose[1, 3]
            # What a column of voxels shares; the sums keep the released code's order.
            column_x = pose[0, 0] * x + pose[1, 0] * y
            column_y = pose[0, 1] * x + pose[1, 1] * y
            column_z = pose[0, 2] * x + pose[1, 2] * y
            for k in range(distance.shape[2]):
                z = (origin_m[2] + np.float32(k) * voxel_m) - pose[2, 3]
                camera_z = column_z + pose[2, 2] * z
                if camera_z <= 0:
                    continue
                camera_x = column_x + pose[2, 0] * z
                camera_y = column_y + pose[2, 1] * z
                u = camera[0, 0] * (camera_x / camera_z) + camera[0, 2]
                v = camera[1, 1] * (camera_y / camera_z) + camera[1, 2]
                if not (-0.5 < u < width and -0.5 < v < height):
                    continue
                # Half a pixel rounds away from zero; the sum is double, because in single 0.49999997 gives 1.
                column, row = int(u + 0.5), int(v + 0.5)
                if column >= width or row >= height:
                    continue
                measured = depth_m[row, column]
                if measured <= SMALLEST_DEPTH_M or measured > max_depth_m:
                    continue
                difference = (measured - camera_z) * facing[row, column]
                if difference <= -behind_m:
                    hidden[i, j, k] = True
                    continue
                weight[i, j, k] += np.uint16(1)
                relative = difference / falloff_m
                counts = facing[row, column]
                if difference < 0:
                    relative *= behind_faster
                    counts *= behind_gain
                counts *= np.exp(-relative * relative) if relative < FAR_IN_FRONT else LEAST_FREE_WEIGHT
                before = evidence[i, j, k]
                evidence[i, j, k] = before + counts
                value = min(one, difference / truncation_m)
                distance[i, j, k] = (distance[i, j, k] * before + value * counts) / (before + counts)


def extract_surface(distance: npt.NDArray[np.float32], origin_m: FloatArray, voxel_m: float) -> TriangleMesh:
    """Zero surface of `distance` (X, Y, Z; positive outside) by Lewiner's marching cubes.

    A layer of free space around the grid closes what touches its border. Without a surface the mesh is empty.
    """
    padded = np.pad(distance, 1, constant_values=1.0)
    if not padded.min() < 0:
        return TriangleMesh(np.zeros((0, 3)), np.zeros((0, 3), dtype=np.int64))
    vertices, faces, _, _ = marching_cubes(padded, level=0.0, method="lewiner")
    return TriangleMesh(origin_m + (vertices.astype(float) - 1.0) * voxel_m, faces.astype(np.int64))


def largest_piece(mesh: TriangleMesh) -> TriangleMesh:
    """The connected piece of the largest signed volume: no crumbs, no cavities (their volume is negative)."""
    n_vertices = len(mesh.vertices_m)
    edges = np.concatenate([mesh.faces[:, [0, 1]], mesh.faces[:, [1, 2]]])
    graph = coo_array(
        (np.ones(len(edges), dtype=np.int8), (edges[:, 0], edges[:, 1])), (n_vertices, n_vertices)
    )
    n_pieces, piece_of_vertex = connected_components(graph, directed=False)
    piece_of_face = piece_of_vertex[mesh.faces[:, 0]]
    a, b, c = (mesh.vertices_m[mesh.faces[:, k]] - mesh.vertices_m[0] for k in range(3))
    volumes = np.bincount(piece_of_face, np.einsum("ij,ij->i", a, np.cross(b, c)), minlength=n_pieces)
    best = int(np.argmax(volumes))
    kept = piece_of_vertex == best
    new_index = np.cumsum(kept) - 1
    return TriangleMesh(mesh.vertices_m[kept], new_index[mesh.faces[piece_of_face == best]])
