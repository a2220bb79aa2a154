"""Networks and views for tests: nothing trained, nothing rendered."""

from __future__ import annotations

import numpy as np

from core.appearance.network import LAYERS, Network
from core.scan.model import CropBox, Intrinsics, RgbdFrame

INTRINSICS = Intrinsics(fx=500.0, fy=500.0, cx=319.5, cy=239.5)
BOX = CropBox((-0.2, -0.2, -0.01), (0.2, 0.2, 0.3))
HEIGHT_M = 0.6
DOWN = np.array([[1.0, 0, 0, 0], [0, -1, 0, 0], [0, 0, -1, HEIGHT_M], [0, 0, 0, 1]])
"""A camera above the origin that looks straight down."""


def drawn_network(seed: int = 0) -> Network:
    """Weights drawn at random."""
    random = np.random.default_rng(seed)
    weights = {}
    for name, shape in LAYERS.items():
        weights[f"{name}.kernel"] = random.normal(0, (2 / np.prod(shape[:-1])) ** 0.5, shape)
        weights[f"{name}.shift"] = random.normal(0, 0.1, shape[-1])
        weights[f"{name}.scale"] = random.uniform(0.5, 1.5, shape[-1])
    return Network({name: one.astype(np.float32) for name, one in weights.items()})


def block_frame(left: int, top: int, width: int, height: int, block_m: float = 0.1) -> RgbdFrame:
    """A white block whose top is at a height, over a dark ground far below the box."""
    depth = np.full((480, 640), HEIGHT_M + 0.3, dtype=np.float32)
    color = np.full((480, 640, 3), 40, dtype=np.uint8)
    depth[top : top + height, left : left + width] = HEIGHT_M - block_m
    color[top : top + height, left : left + width] = 230
    return RgbdFrame("frame-000000", color, depth, DOWN)
