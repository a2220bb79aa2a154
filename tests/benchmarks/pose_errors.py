"""Simulated scans with growing pose errors: where the reconstruction fails and where the verdict warns.

Usage: python -m tests.benchmarks.pose_errors [--omega] [--objects A,B] [--seeds N] ...
With --omega, containability is imagined in the reconstructed and in the true mesh, too.
"""

from __future__ import annotations

import argparse
import heapq
from dataclasses import dataclass
from math import radians

import numpy as np
import open3d as o3d

from core.collision import build_collision_model
from core.geometry import FloatArray
from core.imagination.context import ImaginationContext
from core.imagination.drop import imagine_drop
from core.imagination.imagination import WORKER_MODULE
from core.mesh import TriangleMesh
from core.parameters import Parameters, apply_settings
from core.progress import Reporter
from core.quality.measures import ScanQuality
from core.quality.plain_fusion import coarse_volume
from core.quality.verdict import assess
from core.reconstruction.stage import reconstruct
from core.scan.model import crop_box_of
from core.workers import WorkerPool
from hardware.cell import read_cell
from hardware.scanning.simulated import simulate_scan
from hardware.simulation.depth_noise import DepthNoise
from hardware.simulation.objects import builtin_object
from hardware.simulation.placing import place_on_platform, transform_mesh

LEVELS = ((0.0, 0.0), (1.0, 0.25), (2.0, 0.5), (3.0, 1.0), (5.0, 1.5), (8.0, 2.5), (12.0, 4.0))
"""Pose errors in mm and degrees."""
CELL_M = 0.002
CAPACITY_HOLDS = 0.1
SMALLEST_CAPACITY_ML = 1.0
COMPLETENESS_HOLDS_M = 0.0025
ABOVE_PLATFORM_M = 0.005
"""The underside is seen by nobody."""


@dataclass(frozen=True)
class Row:
    """One scan: lengths in metres, capacity as a share of the true one; omega of reconstruction and truth."""

    name: str
    level: tuple[float, float]
    seed: int
    accuracy_m: float
    accuracy_p95_m: float
    completeness_m: float
    capacity: float
    quality: ScanQuality
    omega: tuple[float, float] | None

    @property
    def holds(self) -> bool:
        """Whether the capacity is right within a tenth and no wall is missing."""
        capacity_holds = np.isnan(self.capacity) or abs(self.capacity - 1) <= CAPACITY_HOLDS
        return bool(capacity_holds) and self.completeness_m <= COMPLETENESS_HOLDS_M


def main(wanted: argparse.Namespace) -> None:
    """Measure all wanted objects at all wanted pose errors and print a table."""
    parameters = apply_settings(Parameters(), dict(word.split("=", 1) for word in wanted.settings))
    errors_mm = [float(word) for word in wanted.errors_mm.split(",")]
    levels = [level for level in LEVELS if level[0] in errors_mm]
    rows = []
    with WorkerPool(2) as pool:
        pool.start(WORKER_MODULE)
        for level in levels:
            for name in wanted.objects.split(","):
                for seed in range(wanted.seeds):
                    rows.append(measure(name, level, seed, parameters, pool if wanted.omega else None))
                    print_row(rows[-1])
    print_levels(rows, levels)


def measure(
    name: str, level: tuple[float, float], seed: int, parameters: Parameters, pool: WorkerPool | None
) -> Row:
    """Scan, reconstruct and assess one object; with a pool, imagine it too."""
    settings = parameters.reconstruction
    mesh = builtin_object(name)
    noise = DepthNoise(pose_position_m=level[0] / 1000, pose_angle_rad=radians(level[1]))
    scan = simulate_scan(mesh, seed, Reporter(), noise)
    truth = transform_mesh(mesh, place_on_platform(mesh, seed, read_cell().place))
    result = reconstruct(scan, settings, Reporter())
    fused = scan if result.refinement is None else result.refinement.applied_to(scan)
    volume = coarse_volume(fused, crop_box_of(scan, settings))
    platform_m = result.platform_height_m
    to_truth_m = distances_m(result.mesh.vertices_m, truth)
    return Row(
        name,
        level,
        seed,
        float(to_truth_m.mean()),
        float(np.percentile(to_truth_m, 95)),
        completeness_m(truth, result.mesh, platform_m),
        capacity_share(result.mesh, truth, platform_m),
        assess(scan, volume, result),
        None if pool is None else (omega(result.mesh, parameters, pool), omega(truth, parameters, pool)),
    )


def scene_of(mesh: TriangleMesh) -> o3d.t.geometry.RaycastingScene:
    """Make a mesh ready for rays and distances."""
    scene = o3d.t.geometry.RaycastingScene()
    scene.add_triangles(
        o3d.core.Tensor(mesh.vertices_m.astype(np.float32)), o3d.core.Tensor(mesh.faces.astype(np.uint32))
    )
    return scene


def distances_m(points_m: FloatArray, mesh: TriangleMesh) -> FloatArray:
    """Distances (N,) of points (N, 3) to a mesh."""
    found = scene_of(mesh).compute_distance(o3d.core.Tensor(points_m.astype(np.float32)))
    return found.numpy().astype(float)


def completeness_m(truth: TriangleMesh, mesh: TriangleMesh, platform_m: float) -> float:
    """Mean distance from the true surface, without its underside, to the reconstruction."""
    as_open3d = o3d.geometry.TriangleMesh(
        o3d.utility.Vector3dVector(truth.vertices_m), o3d.utility.Vector3iVector(truth.faces)
    )
    points = np.asarray(as_open3d.sample_points_uniformly(4000).points)
    return float(distances_m(points[points[:, 2] > platform_m + ABOVE_PLATFORM_M], mesh).mean())


def capacity_share(mesh: TriangleMesh, truth: TriangleMesh, floor_m: float) -> float:
    """What the mesh would hold as a share of what the true one does; NaN where that is nothing."""
    true_ml = capacity_ml(truth, floor_m)
    return capacity_ml(mesh, floor_m) / true_ml if true_ml > SMALLEST_CAPACITY_ML else np.nan


def capacity_ml(mesh: TriangleMesh, floor_m: float) -> float:
    """What the mesh would hold, by flooding the map of its heights from the border (Barnes et al. 2014)."""
    heights = height_map_m(mesh, floor_m)
    water = np.full_like(heights, np.inf)
    border = np.zeros(heights.shape, dtype=bool)
    border[[0, -1]], border[:, [0, -1]] = True, True
    water[border] = heights[border]
    queue = [(heights[i, j], i, j) for i, j in np.argwhere(border)]
    heapq.heapify(queue)
    while queue:
        level, i, j = heapq.heappop(queue)
        for a, b in ((i + 1, j), (i - 1, j), (i, j + 1), (i, j - 1)):
            if 0 <= a < len(water) and 0 <= b < water.shape[1] and max(level, heights[a, b]) < water[a, b]:
                water[a, b] = max(level, heights[a, b])
                heapq.heappush(queue, (water[a, b], a, b))
    return float((water - heights).sum() * CELL_M**2 * 1e6)


def height_map_m(mesh: TriangleMesh, floor_m: float) -> FloatArray:
    """Height (X, Y) of the surface as seen from above, `floor_m` beside it."""
    low, high = mesh.aabb_min_m - 2 * CELL_M, mesh.aabb_max_m + 2 * CELL_M
    x, y = np.meshgrid(np.arange(low[0], high[0], CELL_M), np.arange(low[1], high[1], CELL_M), indexing="ij")
    rays = np.stack([x, y, np.full_like(x, high[2]), 0 * x, 0 * x, -np.ones_like(x)], axis=-1)
    down = scene_of(mesh).cast_rays(o3d.core.Tensor(rays.astype(np.float32)))["t_hit"].numpy().astype(float)
    return np.where(np.isfinite(down), high[2] - down, floor_m)


def omega(mesh: TriangleMesh, parameters: Parameters, pool: WorkerPool) -> float:
    """Imagine the drop onto a mesh and return its containability Omega."""
    model = build_collision_model(mesh, parameters.collision, Reporter())
    return imagine_drop(ImaginationContext(parameters, pool, Reporter()), model).omega


def print_row(row: Row) -> None:
    """Print one scan."""
    quality = row.quality
    sd_m, residual_m = quality.table_sd_m, quality.residual_m
    imagined = "" if row.omega is None else f"  omega {row.omega[0]:.3f} (true {row.omega[1]:.3f})"
    print(
        f"{row.level[0]:g} mm {row.level[1]:4.2f} deg {row.name:<6}{row.seed}"
        f"  acc {row.accuracy_m * 1e3:5.2f} p95 {row.accuracy_p95_m * 1e3:5.2f}"
        f" compl {row.completeness_m * 1e3:5.2f} cap {row.capacity:4.2f}"
        f"  table {(sd_m or np.nan) * 1e3:4.2f}"
        f" resid {(residual_m or np.nan) * 1e3:4.2f}"
        f" unseen {quality.unseen_share:4.2f} hidden {quality.cavity.area_m2 * 1e4:5.1f} cm2"
        f"  {quality.verdict}{imagined}",
        flush=True,
    )


def print_levels(rows: list[Row], levels: list[tuple[float, float]]) -> None:
    """Print a line for each pose error."""
    print("\npose error      acc  compl  table  resid  held  good usable again  failed without 'again'")
    for level in levels:
        group = [row for row in rows if row.level == level]
        verdicts = [row.quality.verdict for row in group]
        counts = [verdicts.count(verdict) for verdict in ("good", "usable", "scan again")]
        silent = sum(not row.holds and row.quality.verdict != "scan again" for row in group)
        means = [
            1e3 * np.mean(values)
            for values in (
                [row.accuracy_m for row in group],
                [row.completeness_m for row in group],
                [row.quality.table_sd_m or np.nan for row in group],
                [row.quality.residual_m or np.nan for row in group],
            )
        ]
        print(
            f"{level[0]:g} mm {level[1]:4.2f} deg "
            + "".join(f"{mean:7.2f}" for mean in means)
            + f"{sum(row.holds for row in group):4d}/{len(group)}"
            + "{:5d}{:7d}{:6d}".format(*counts)
            + f"{silent:8d}"
        )


def arguments() -> argparse.Namespace:
    """Read the command line."""
    parser = argparse.ArgumentParser(prog="python -m tests.benchmarks.pose_errors")
    parser.add_argument("--omega", action="store_true", help="imagine containability, too")
    parser.add_argument("--objects", default="mug,bowl,plate,box,glass")
    parser.add_argument("--seeds", type=int, default=2)
    parser.add_argument("--errors-mm", default="0,1,2,3,5,8,12", help="some of these")
    parser.add_argument("settings", nargs="*", metavar="NAME=VALUE", help="parameters")
    return parser.parse_args()


if __name__ == "__main__":
    main(arguments())
