from __future__ import annotations

from dataclasses import dataclass
from math import cos, radians, sin

import numpy as np

from core.geometry import look_at, make_pose, rotation_z
from core.mesh import TriangleMesh
from core.quality.next_views import DepthCamera
from core.reconstruction.tsdf import TsdfVolume
from core.scan.model import CropBox, RgbdFrame, Scan
from hardware.simulation.depth_camera import CARMINE_INTRINSICS, HEIGHT, WIDTH, SimulatedDepthCamera
from hardware.simulation.depth_noise import DepthNoise, disturb_pose
from hardware.simulation.objects import turned
from hardware.simulation.world import World
from tests.ideal_rings import SCAN_RINGS, scan_views

PLATFORM_M = 0.08
TABLE_M = 0.015
VOXEL_M = 0.004
BOX = CropBox((-0.15, -0.15, 0.03), (0.15, 0.15, 0.32))
FEW_RINGS = SCAN_RINGS[::2]
LOW_RINGS = SCAN_RINGS[:3]
"""Up to 66 degrees above the horizon: a tall vase does not show its floor."""
CAMERA = DepthCamera(CARMINE_INTRINSICS, WIDTH, HEIGHT)


@dataclass
class Studio:
    """An object beside the middle of a platform, and a camera that goes anywhere."""

    mesh: TriangleMesh
    seed: int

    def scan(self, rings=SCAN_RINGS) -> Scan:
        poses = scan_views([0, 0, PLATFORM_M + 0.06], rings)
        return Scan(self.take(poses), CARMINE_INTRINSICS, PLATFORM_M, BOX)

    def take(self, poses, first: int = 0) -> tuple[RgbdFrame, ...]:
        camera = SimulatedDepthCamera(World(self.mesh, np.array([0, 0, TABLE_M])), DepthNoise())
        frames = []
        for k, pose in enumerate(poses, start=first):
            random = np.random.default_rng([self.seed, k])
            color, depth = camera.capture(disturb_pose(pose, DepthNoise(), random), random)
            frames.append(RgbdFrame(f"frame-{k:06d}", color, depth, pose))
        return tuple(frames)


def on_platform(mesh: TriangleMesh, seed: int = 0) -> Studio:
    x, y = np.random.default_rng(seed).uniform(-0.02, 0.02, size=2)
    return Studio(mesh.translated(np.array([x, y, PLATFORM_M - mesh.aabb_min_m[2]])), seed)


def tube(opening_m: float, depth_m: float) -> TriangleMesh:
    """A straight vase; wall and floor 4 and 8 mm."""
    inside, outside, height = opening_m / 2, opening_m / 2 + 0.004, depth_m + 0.008
    return turned([(outside, 0.0), (outside, height), (inside, height), (inside, 0.008)])


def upside_down(mesh: TriangleMesh) -> TriangleMesh:
    return TriangleMesh(mesh.vertices_m * [1, -1, -1], mesh.faces)


def dome(target_m) -> np.ndarray:
    """Poses that look at a target from 60 to 90 degrees, 0.45 to 0.75 m away, turned by eighths."""
    poses = []
    for elevation in np.radians([60, 66, 72, 78, 84, 90]):
        for azimuth in np.radians(np.arange(0, 360, 30)) if elevation < 1.57 else [0.0]:
            outwards = [cos(azimuth) * cos(elevation), sin(azimuth) * cos(elevation), sin(elevation)]
            for distance_m in (0.45, 0.6, 0.75):
                pose = look_at(target_m + distance_m * np.array(outwards), target_m)
                poses += [
                    pose @ make_pose(rotation_z(radians(roll)), [0, 0, 0]) for roll in range(0, 360, 45)
                ]
    return np.array(poses)


def shaft(unseen_below_m: float = 0.1, floor_m: float = 0.0) -> TsdfVolume:
    """A square shaft of 11 voxels within a wall of 3, 120 mm high, of which only the upper part was seen."""
    volume = TsdfVolume((-0.06, -0.06, 0.0), (0.064, 0.064, 0.2), VOXEL_M, 0.016)
    steps = np.arange(31) - 15
    across = np.maximum(abs(steps[:, None]), abs(steps))[:, :, None]
    layers = np.arange(50)[None, None]
    volume.weight[:] = 1
    volume.distance[(across > 5) & (across <= 8) & (layers < 30)] = -0.5
    volume.weight[(across <= 5) & (layers < unseen_below_m / VOXEL_M)] = 0
    is_floor = (across <= 5) & (layers < floor_m / VOXEL_M)
    volume.weight[is_floor], volume.distance[is_floor] = 1, -0.5
    return volume
