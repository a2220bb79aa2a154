"""A simulated depth camera over a table and an invisible platform, with exact or erring poses."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import open3d as o3d
import pytest
import trimesh
from scipy.spatial.transform import Rotation

from core.geometry import FloatArray, invert_pose, look_at, make_pose
from core.parameters.reconstruction import ReconstructionParameters
from core.progress import Reporter
from core.scan import Intrinsics, RgbdFrame, Scan

WIDTH, HEIGHT = 320, 240
INTRINSICS = Intrinsics(266.0, 266.0, 159.5, 119.5)
TABLE_M = 0.02
PLATFORM_M = 0.08
CENTER_M = (0.4, 0.1)


class Listener(Reporter):
    """Keeps what it is told."""

    def __init__(self) -> None:
        super().__init__()
        self.warnings: list[str] = []
        self.steps: list[tuple[str, float, float]] = []

    def warn(self, sentence: str) -> None:
        self.warnings.append(sentence)

    def progress(self, stage: str, done: float, total: float) -> None:
        self.steps.append((stage, done, total))


def camera_poses() -> list[FloatArray]:
    """Two rings of eight views, 0.6 m from the object."""
    target = np.array([*CENTER_M, PLATFORM_M + 0.03])
    poses = []
    for elevation in np.deg2rad([25.0, 60.0]):
        for azimuth in np.linspace(0, 2 * np.pi, 8, endpoint=False) + elevation:
            direction = [
                np.cos(elevation) * np.cos(azimuth),
                np.cos(elevation) * np.sin(azimuth),
                np.sin(elevation),
            ]
            poses.append(look_at(target + 0.6 * np.array(direction), target))
    return poses


def simulate(
    body: trimesh.Trimesh,
    *,
    base_m: float = PLATFORM_M,
    translation_error_m: float = 0.0,
    rotation_error_rad: float = 0.0,
    table: bool = True,
) -> Scan:
    """Scan a body given with its base's middle at the origin; errors are standard deviations per axis."""
    scene = o3d.t.geometry.RaycastingScene()
    placed = np.asarray(body.vertices) + np.array([*CENTER_M, base_m])
    scene.add_triangles(placed.astype(np.float32), np.asarray(body.faces, dtype=np.uint32))
    if table:
        sheet = trimesh.creation.box((2.0, 2.0, 0.01))
        top = np.asarray(sheet.vertices) + np.array([*CENTER_M, TABLE_M - 0.005])
        scene.add_triangles(top.astype(np.float32), np.asarray(sheet.faces, dtype=np.uint32))
    random = np.random.default_rng(0)
    frames = []
    for index, pose in enumerate(camera_poses()):
        # Open3D's rays pass (0.5, 0.5) of a pixel, our pixels have their centres at whole numbers.
        camera = INTRINSICS.matrix + np.array([[0, 0, 0.5], [0, 0, 0.5], [0, 0, 0]])
        rays = scene.create_rays_pinhole(camera, invert_pose(pose), WIDTH, HEIGHT)
        depth_m = scene.cast_rays(rays)["t_hit"].numpy()
        depth_m[~np.isfinite(depth_m)] = 0
        rotation = Rotation.from_rotvec(random.normal(0, 1, 3) * rotation_error_rad).as_matrix()
        erring = pose @ make_pose(rotation, random.normal(0, 1, 3) * translation_error_m)
        color = np.zeros((HEIGHT, WIDTH, 3), dtype=np.uint8)
        frames.append(RgbdFrame(f"frame-{index:06d}", color, np.round(depth_m, 3).astype(np.float32), erring))
    return Scan(tuple(frames), INTRINSICS, PLATFORM_M if base_m == PLATFORM_M else None)


def block() -> trimesh.Trimesh:
    """A solid block, 80 x 60 x 50 mm."""
    return trimesh.creation.box((0.08, 0.06, 0.05)).apply_translation([0, 0, 0.025])


def block_and_crumb() -> trimesh.Trimesh:
    """The block and, 10 mm beside it (within the clusters' gap), a crumb of 12 mm."""
    crumb = trimesh.creation.box((0.012, 0.012, 0.012)).apply_translation([0.056, 0, 0.006])
    return trimesh.util.concatenate([block(), crumb])


def bowl() -> trimesh.Trimesh:
    """A cylindrical bowl: 100 mm across, 50 mm high, walls and floor of 8 mm."""
    profile = [[0, 0], [0.05, 0], [0.05, 0.05], [0.042, 0.05], [0.042, 0.008], [0, 0.008]]
    return trimesh.creation.revolve(profile, sections=64)


def plate() -> trimesh.Trimesh:
    """A plate whose floor of 4 mm lies below the margin of the plane segmentation, with a rim of 20 mm."""
    profile = [[0, 0], [0.06, 0], [0.06, 0.02], [0.052, 0.02], [0.052, 0.004], [0, 0.004]]
    return trimesh.creation.revolve(profile, sections=64)


def thin_cup() -> trimesh.Trimesh:
    """A cup of 90 mm with a wall of 2 mm, so wide and low that all views see its inside."""
    profile = [[0, 0], [0.045, 0], [0.045, 0.05], [0.043, 0.05], [0.043, 0.006], [0, 0.006]]
    return trimesh.creation.revolve(profile, sections=96)


BODIES: dict[str, Callable[[], trimesh.Trimesh]] = {
    "block": block,
    "block_and_crumb": block_and_crumb,
    "bowl": bowl,
    "plate": plate,
    "thin_cup": thin_cup,
}


@pytest.fixture(scope="session")
def simulated() -> Callable[..., Scan]:
    """`simulated("bowl", base_m=...)`: a scan of one of the bodies."""
    return lambda name, **conditions: simulate(BODIES[name](), **conditions)


@pytest.fixture
def listener() -> Listener:
    return Listener()


@pytest.fixture(scope="session")
def parameters() -> ReconstructionParameters:
    """A box around the object, above the table."""
    return ReconstructionParameters(crop_min_m=(0.28, -0.02, 0.05), crop_max_m=(0.52, 0.22, 0.2))


@pytest.fixture(scope="session")
def block_scan(simulated: Callable[..., Scan]) -> Scan:
    return simulated("block")


@pytest.fixture(scope="session")
def bowl_scan(simulated: Callable[..., Scan]) -> Scan:
    return simulated("bowl")
