"""Run as a program with a folder for temporary files: take a picture, print the renderer's name last."""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np

from core.imagination.rendering.camera import aabb_corners, frame
from core.imagination.rendering.scene import Scene


def main(folder: Path) -> None:
    """Take the picture; with a broken driver the process ends here."""
    aabb_m = np.array([[0.0, 0.0, 0.0], [0.1, 0.1, 0.1]])
    with Scene(folder, aabb_m, with_egl=True) as scene:
        scene.add_ground(0.0)
        scene.photograph(frame(aabb_corners(*aabb_m), scene.forward, 1.0), 64, 64)
        renderer = scene.renderer
    print("\n" + renderer, flush=True)


if __name__ == "__main__":
    main(Path(sys.argv[1]))
