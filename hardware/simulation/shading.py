"""Colour for the simulated camera: enough light and contrast for a person to recognise the object."""

from __future__ import annotations

import numpy as np

from core.geometry import AnyArray, BoolArray, FloatArray
from core.scan.model import ColorImage
from hardware.simulation.world import Hits

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
