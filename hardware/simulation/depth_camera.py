"""A simulated PrimeSense Carmine 1.09 by ray casting: the same image on every machine."""

from __future__ import annotations

import numpy as np

from core.geometry import AnyArray, BoolArray, FloatArray, transform_points
from core.scan.model import ColorImage, DepthImage, Intrinsics
from hardware.simulation.depth_noise import DepthNoise, disturb
from hardware.simulation.world import Hits, World

_OBJECT_COLOR = np.array([64, 124, 196], dtype=np.float32)
_BOARD_COLORS = np.array([[188, 160, 124], [174, 145, 109]], dtype=np.float32)
_BACKGROUND_COLOR = np.array([226, 228, 230], dtype=np.uint8)
_BOARD_WIDTH_M = 0.1
_AMBIENT, _HEADLIGHT, _LAMP = 0.28, 0.32, 0.5


def shade(hits: Hits, unit_rays: FloatArray, to_lamp: FloatArray, in_shadow: BoolArray) -> ColorImage:
    """Paint what the rays met: a blue object over a table of boards, lit by a lamp and from the camera.

    Args:
        hits: what (H, W) rays met.
        unit_rays: (H, W, 3) their directions, of length 1.
        to_lamp: (H, W, 3) directions from the points met to the lamp, of any length.
        in_shadow: (H, W) whether something stands between.
    """
    # Triangles are seen from either side; the side that is seen is the one that is lit.
    facing = np.einsum("hwk,hwk->hw", hits.normals, unit_rays)
    lamp = -np.sign(facing) * np.einsum("hwk,hwk->hw", hits.normals, to_lamp)
    lamp = np.clip(lamp / np.linalg.norm(to_lamp, axis=-1), 0, 1) * ~in_shadow
    light = _AMBIENT + _HEADLIGHT * np.abs(facing) + _LAMP * lamp
    color: ColorImage = (_albedo(hits) * light[..., None]).clip(0, 255).astype(np.uint8)
    color[~np.isfinite(hits.distance)] = _BACKGROUND_COLOR
    return color


def _albedo(hits: Hits) -> AnyArray:
    board = np.floor(hits.points_m[..., 1] / _BOARD_WIDTH_M).astype(int) % 2
    return np.where(hits.on_object[..., None], _OBJECT_COLOR, _BOARD_COLORS[board])


CARMINE_INTRINSICS = Intrinsics(fx=532.58, fy=532.21, cx=316.04, cy=236.03)
WIDTH, HEIGHT = 640, 480


class SimulatedDepthCamera:
    """Looks at a world; its depth is registered to its colour, as the real one delivers it.

    `noise=None` makes it perfect, without a minimum range and without shadow.
    """

    def __init__(self, world: World, noise: DepthNoise | None) -> None:
        self.intrinsics = CARMINE_INTRINSICS
        self._world = world
        self._noise = noise
        columns, rows = np.meshgrid(np.arange(WIDTH), np.arange(HEIGHT))
        x = (columns - self.intrinsics.cx) / self.intrinsics.fx
        y = (rows - self.intrinsics.cy) / self.intrinsics.fy
        # With z = 1 the length along a ray, in lengths of its direction, is the depth itself.
        self._rays = np.stack([x, y, np.ones_like(x)], axis=-1)
        self._ray_lengths = np.linalg.norm(self._rays, axis=-1)

    def capture(
        self, T_base_camera: FloatArray, random: np.random.Generator
    ) -> tuple[ColorImage, DepthImage]:
        """Take colour (480, 640, 3) and depth (480, 640) in metres, 0 = none, from the camera's true pose."""
        directions = self._rays @ T_base_camera[:3, :3].T
        hits = self._world.cast(T_base_camera[:3, 3], directions)
        unit_rays = directions / self._ray_lengths[..., None]
        depth = self._depth(T_base_camera, hits, unit_rays, random)
        return self._color(hits, unit_rays), depth.astype(np.float32)

    def _color(self, hits: Hits, unit_rays: FloatArray) -> ColorImage:
        lamp_m = self._world.lamp_m
        if lamp_m is None:
            return np.zeros((HEIGHT, WIDTH, 3), dtype=np.uint8)
        return shade(hits, unit_rays, lamp_m - hits.points_m, self._world.hidden(hits.points_m, lamp_m))

    def _depth(
        self, T_base_camera: FloatArray, hits: Hits, unit_rays: FloatArray, random: np.random.Generator
    ) -> FloatArray:
        met = np.isfinite(hits.distance)
        true_depth = np.where(met, hits.distance, 0.0)
        if self._noise is None:
            return true_depth
        facing = np.abs(np.einsum("hwk,hwk->hw", unit_rays, hits.normals)).clip(0, 1)
        depth = disturb(true_depth, np.arccos(facing), self._noise, random)
        depth[~self._projector_lights(T_base_camera, hits, self._noise.baseline_m)] = 0
        return depth

    def _projector_lights(self, T_base_camera: FloatArray, hits: Hits, baseline_m: float) -> BoolArray:
        projector = transform_points(T_base_camera, [baseline_m, 0.0, 0.0])
        return ~self._world.hidden(hits.points_m, projector)
