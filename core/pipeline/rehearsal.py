"""What follows a scan's last view, once and in small, by workers that wait for it.

Open3D takes a worker a second to load, and compiled functions are read from their cache when they are first
called. None of that needs the object.
"""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np

from core.collision import build_collision_model
from core.geometry import FloatArray, invert_pose, look_at
from core.imagination.capacity.water import find_basin
from core.parameters import Parameters
from core.progress import Reporter
from core.reconstruction.stage import reconstruct
from core.scan.model import CropBox, Intrinsics, RgbdFrame, Scan
from core.workers import Task, WorkerPool, WorkerReporter

_WIDTH_PX, _HEIGHT_PX = 80, 60
_CAMERA = Intrinsics(100.0, 100.0, 39.5, 29.5)
_PLATFORM_M = 0.02
_INNER_M, _WALL_M = 0.03, 0.004
_VIEWS = 6
_AWAY_M = 0.3
_BOX = CropBox((-0.04, -0.04, 0.012), (0.04, 0.04, 0.08))
_FEW_FACES, _FEW_POINTS = 500, 5000


def small_scan() -> Scan:
    """Views from around of an open box, 38 mm wide and on a table, at the base frame's origin."""
    import open3d as o3d

    scene: Any = o3d.t.geometry.RaycastingScene()
    for low, high in _slabs():
        body: Any = o3d.geometry.TriangleMesh.create_box(*(high - low)).translate(low)
        scene.add_triangles(o3d.t.geometry.TriangleMesh.from_legacy(body))
    target = np.array([0.0, 0.0, _PLATFORM_M + _INNER_M / 2])
    color = np.zeros((_HEIGHT_PX, _WIDTH_PX, 3), dtype=np.uint8)
    frames = []
    for index, azimuth in enumerate(np.linspace(0, 2 * np.pi, _VIEWS, endpoint=False)):
        direction = np.array([np.cos(azimuth), np.sin(azimuth), 1.4]) / np.hypot(1, 1.4)
        pose = look_at(target + _AWAY_M * direction, target)
        rays = scene.create_rays_pinhole(_CAMERA.matrix, invert_pose(pose), _WIDTH_PX, _HEIGHT_PX)
        seen_m = np.nan_to_num(scene.cast_rays(rays)["t_hit"].numpy(), posinf=0.0)
        frames.append(RgbdFrame(f"frame-{index:06d}", color, seen_m, pose))
    return Scan(tuple(frames), _CAMERA, _PLATFORM_M, _BOX)


def _slabs() -> list[tuple[FloatArray, FloatArray]]:
    """Lower and upper corners (3,) of the table, the box's floor and its four walls."""
    inner, outer, foot = _INNER_M / 2, _INNER_M / 2 + _WALL_M, _PLATFORM_M
    top = foot + _INNER_M
    corners: list[list[tuple[float, float, float]]] = [
        [(-1.0, -1.0, -0.02), (1.0, 1.0, 0.0)],
        [(-outer, -outer, foot), (outer, outer, foot + _WALL_M)],
        [(-outer, -outer, foot), (-inner, outer, top)],
        [(inner, -outer, foot), (outer, outer, top)],
        [(-inner, -outer, foot), (inner, -inner, top)],
        [(-inner, inner, foot), (inner, outer, top)],
    ]
    return [(np.array(low), np.array(high)) for low, high in corners]


@cache
def rehearse() -> None:
    """Reconstruct the small scan, simplify its surface, and find what it holds: once in each process."""
    parameters, reporter = Parameters(), WorkerReporter()
    found = reconstruct(small_scan(), parameters.reconstruction, reporter)
    few = parameters.collision.model_copy(update={"max_faces": _FEW_FACES})
    surface = build_collision_model(found.mesh, few, reporter).surface
    find_basin(surface, parameters.particle.diameter_m, 0.0, _FEW_POINTS)


def rehearse_in(pool: WorkerPool, reporter: Reporter) -> None:
    """Let each worker of an idle pool rehearse.

    Raises:
        Cancelled: the reporter was asked to stop.
        WorkerError: a worker died.
    """
    pool.run([Task(rehearse, ())] * pool.workers, "rehearsal", reporter)
