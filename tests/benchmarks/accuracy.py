"""How true the reconstruction of simulated scans is: `python -m tests.benchmarks.accuracy` (make accuracy).

Per object, over the seeds: distance from what the views could see of the true surface to the reconstruction
and back (mean and 95th percentile, above 5 mm over the platform, millimetres), the capacity as a share of the
true one (flood fill of the height map), holes, and seconds. A hole is a wall sample that a ray passes from
one side of the wall to the other without a hit (6 mm below the object's top and lower), or water that stands
more than 3 mm lower than in the true object.
"""

from __future__ import annotations

import argparse
import math
import time
from dataclasses import dataclass

import numpy as np
import open3d as o3d
import trimesh
from skimage.morphology import reconstruction as flood

from core.geometry import FloatArray
from core.mesh import TriangleMesh
from core.parameters import Parameters, apply_settings
from core.progress import Reporter
from core.reconstruction.stage import reconstruct
from core.scan import Scan
from hardware.cell import read_cell
from hardware.scanning.simulated import simulate_scan
from hardware.simulation.depth_noise import DepthNoise
from hardware.simulation.objects import _vessel, builtin_object
from hardware.simulation.placing import place_on_platform, transform_mesh

OBJECTS = ("mug", "bowl", "plate", "vase", "glass", "thin glass", "box", "bottle")
N_SAMPLES = 6000
FOOT_M = 0.005
FEWEST_VIEWS = 3
"""A surface seen by fewer is called hidden."""
STEEPEST_RAD = math.radians(75)
CELL_M = 0.002
LEAST_CAPACITY_M3 = 5e-6
THICKEST_WALL_M = 0.012
BESIDE_M = 0.005
RIM_M = 0.006
LEAST_WATER_LOSS_M = 0.003
COLUMNS = ("hidden %", "truth-rec", "95 %", "rec-truth", "95 %", "capacity", "water mm", "holes /1000", "s")


def make_object(name: str) -> TriangleMesh:
    """A built-in object, or the glass with a wall of 2 mm."""
    if name == "thin glass":
        return _vessel([(0.0290, 0.0), (0.0300, 0.002), (0.0340, 0.06), (0.0380, 0.119)], 0.002, 0.008)
    return builtin_object(name)


def scene_of(mesh: TriangleMesh) -> o3d.t.geometry.RaycastingScene:
    scene = o3d.t.geometry.RaycastingScene()
    scene.add_triangles(mesh.vertices_m.astype(np.float32), mesh.faces.astype(np.uint32))
    return scene


def cast(scene: o3d.t.geometry.RaycastingScene, starts: FloatArray, directions: FloatArray) -> FloatArray:
    """Distance (N,) to the first hit in lengths of the directions (N, 3); infinite without."""
    rays = np.concatenate([starts, directions], axis=-1).astype(np.float32)
    return scene.cast_rays(rays)["t_hit"].numpy().astype(float)


def distances_mm(scene: o3d.t.geometry.RaycastingScene, points: FloatArray) -> FloatArray:
    return 1000 * scene.compute_distance(points.astype(np.float32)).numpy().astype(float)


@dataclass(frozen=True)
class Basin:
    """What a height map holds: volume, and the level of the deepest water."""

    volume_m3: float
    level_m: float

    @staticmethod
    def of(mesh: TriangleMesh, low: FloatArray, high: FloatArray, floor_m: float) -> Basin:
        x, y = np.meshgrid(
            np.arange(low[0] - 2 * CELL_M, high[0] + 2 * CELL_M, CELL_M),
            np.arange(low[1] - 2 * CELL_M, high[1] + 2 * CELL_M, CELL_M),
            indexing="ij",
        )
        above_m = high[2] + 0.02
        starts = np.stack([x, y, np.full_like(x, above_m)], axis=-1)
        hit = cast(scene_of(mesh), starts, np.broadcast_to([0.0, 0.0, -1.0], starts.shape))
        ground = np.where(np.isfinite(hit), above_m - hit, floor_m)
        rain = np.full_like(ground, ground.max())
        for border in (np.s_[0], np.s_[-1], np.s_[:, 0], np.s_[:, -1]):
            rain[border] = ground[border]
        depth = flood(rain, ground, method="erosion") - ground
        deepest = np.unravel_index(depth.argmax(), depth.shape)
        return Basin(float(depth.sum()) * CELL_M**2, float((ground + depth)[deepest]))


class Truth:
    """The true object in its place, sampled where the views see it."""

    def __init__(self, mesh: TriangleMesh, scan: Scan) -> None:
        self.mesh, self.scene = mesh, scene_of(mesh)
        self.floor_m = float(scan.platform_height_m or mesh.aabb_min_m[2])
        self.basin = self._basin(mesh)
        body = trimesh.Trimesh(mesh.vertices_m, mesh.faces, process=False)
        points, faces = trimesh.sample.sample_surface(body, N_SAMPLES, seed=0)
        points, normals = np.asarray(points), body.face_normals[faces]
        inside_another = (
            self.scene.compute_signed_distance((points + 1e-4 * normals).astype(np.float32)).numpy() < 0
        )
        high = (points[:, 2] > self.floor_m + FOOT_M) & ~inside_another
        seen = high & (self._n_views(points, normals, scan) >= FEWEST_VIEWS)
        self.hidden = 1 - seen.sum() / high.sum()
        self.points = points[seen]
        self.wall_starts, self.wall_directions = self._walls(points[seen], normals[seen])

    def judge(self, mesh: TriangleMesh) -> list[float]:
        """All columns but the seconds."""
        scene = scene_of(mesh)
        forth = distances_mm(scene, self.points)
        vertices = mesh.vertices_m[mesh.vertices_m[:, 2] > self.floor_m + FOOT_M]
        back = distances_mm(self.scene, vertices)
        basin, has_basin = self._basin(mesh), self.basin.volume_m3 > LEAST_CAPACITY_M3
        passed = ~(cast(scene, self.wall_starts, self.wall_directions) < 1)
        return [
            100 * self.hidden,
            float(forth.mean()),
            float(np.percentile(forth, 95)),
            float(back.mean()),
            float(np.percentile(back, 95)),
            basin.volume_m3 / self.basin.volume_m3 if has_basin else math.nan,
            1000 * (basin.level_m - self.basin.level_m) if has_basin else math.nan,
            1000 * float(passed.mean()) if len(passed) else 0.0,
        ]

    def _basin(self, mesh: TriangleMesh) -> Basin:
        return Basin.of(mesh, self.mesh.aabb_min_m, self.mesh.aabb_max_m, self.floor_m)

    def _n_views(self, points: FloatArray, normals: FloatArray, scan: Scan) -> FloatArray:
        n_views = np.zeros(len(points))
        for frame in scan.frames:
            to_camera = frame.T_base_camera[:3, 3] - points
            facing = np.einsum("ij,ij->i", to_camera, normals) / np.linalg.norm(to_camera, axis=1)
            free = ~np.isfinite(cast(self.scene, points + 1e-4 * normals, to_camera))
            n_views += free & (facing > math.cos(STEEPEST_RAD))
        return n_views

    def _walls(self, points: FloatArray, normals: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Starts and directions of rays (N, 3) through every thin wall, from free space to free space."""
        thickness = cast(self.scene, points - 1e-4 * normals, -normals)
        is_wall = (thickness < THICKEST_WALL_M) & (points[:, 2] < self.mesh.aabb_max_m[2] - RIM_M)
        points, normals, thickness = points[is_wall], normals[is_wall], thickness[is_wall]
        starts = points + BESIDE_M * normals
        ends = points - (thickness + BESIDE_M)[:, None] * normals
        free = [
            self.scene.compute_signed_distance(p.astype(np.float32)).numpy() > BESIDE_M / 2
            for p in (starts, ends)
        ]
        both = free[0] & free[1] & (ends[:, 2] > self.floor_m)
        return starts[both], (ends - starts)[both]


def is_holed(row: FloatArray) -> bool:
    return bool(row[7] > 0 or row[6] < -1000 * LEAST_WATER_LOSS_M)


def measure(name: str, seed: int, noise: DepthNoise, parameters: Parameters) -> FloatArray:
    """All columns for one scan."""
    mesh = make_object(name)
    scan = simulate_scan(mesh, seed, Reporter(), noise=noise)
    placed = transform_mesh(mesh, place_on_platform(mesh, seed, read_cell().place))
    truth = Truth(placed, scan)
    start_s = time.perf_counter()
    result = reconstruct(scan, parameters.reconstruction, Reporter())
    seconds = time.perf_counter() - start_s
    return np.array([*truth.judge(result.mesh), seconds])


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--seeds", type=int, default=5)
    parser.add_argument("--pose-mm", type=float, default=1.0)
    parser.add_argument("--pose-deg", type=float, default=0.25)
    parser.add_argument("--objects", default=",".join(OBJECTS))
    parser.add_argument("--set", action="append", default=[], metavar="NAME=VALUE")
    chosen = parser.parse_args()
    noise = DepthNoise(pose_position_m=chosen.pose_mm / 1000, pose_angle_rad=math.radians(chosen.pose_deg))
    parameters = apply_settings(Parameters(), dict(each.split("=", 1) for each in chosen.set))
    print(f"pose error {chosen.pose_mm:g} mm / {chosen.pose_deg:g} deg (rms), {chosen.seeds} seeds")
    print(f"{'':12}" + "".join(f"{column:>12}" for column in (*COLUMNS, "worst", "capacities", "holed")))
    for name in chosen.objects.split(","):
        rows = np.array([measure(name, seed, noise, parameters) for seed in range(chosen.seeds)])
        capacities = f"{rows[:, 5].min():.2f}-{rows[:, 5].max():.2f}"
        cells = [*(f"{value:.2f}" for value in rows.mean(axis=0)), f"{rows[:, 1].max():.2f}", capacities]
        holed = f"{sum(is_holed(row) for row in rows)} of {len(rows)}"
        print(f"{name:12}" + "".join(f"{cell:>12}" for cell in (*cells, holed)), flush=True)


if __name__ == "__main__":
    main()
