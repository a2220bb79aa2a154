"""Frames per second of the desktop's 3D view, replaying 300 candies about an object of 10,000 faces.

Run by `make scene-speed`; exit code 1 if a view of 900 x 600 with 10,000 faces shows fewer than the goal.
"""

from __future__ import annotations

import statistics
import time
from collections.abc import Iterator

import numpy as np
from PySide6.QtCore import QEventLoop
from PySide6.QtWidgets import QApplication

from app.gui.views.scene import ColorScale, Scene3D, prepare_mesh, revolved_mesh
from app.gui.views.scene.shapes import Shape
from app.gui.views.scene.view import SceneView
from core.geometry import FloatArray, make_pose
from core.imagination.rendering.shapes import candy_mesh
from core.motion.arm_models import UR5
from core.parameters import Parameters

SIZES = ((900, 600), (1280, 800))
N_CANDIES = 300
N_FRAMES = 60
GOAL_HZ = 20
_TURNS = np.random.default_rng(1).normal(size=(N_CANDIES, 4))
_JOINTS_RAD = np.array([0.3, -1.6, 1.6, -1.5, -1.57, 0.0])


def main() -> int:
    """Measure what pages show, print it, and return the exit code."""
    application = QApplication([])
    rates_hz = []
    for width, height in SIZES:
        for n_faces in (10_000, 200_000):
            scene = replay_scene(n_faces)
            scene.resize(width, height)
            seconds = frame_seconds(scene, N_FRAMES)
            median, worst = statistics.median(seconds), max(seconds)
            print(
                f"{width}x{height}, {n_faces} faces: {1 / median:.0f} frames/s "
                f"(median {1e3 * median:.0f} ms, worst {1e3 * worst:.0f} ms)"
            )
            rates_hz.append(1 / median)
            scene.close()
    application.quit()
    is_met = rates_hz[0] >= GOAL_HZ
    print(f"Goal: {GOAL_HZ} frames a second in the first: {'met' if is_met else 'missed'}.")
    return 0 if is_met else 1


def replay_scene(n_faces: int) -> Scene3D:
    """A view as the imagination's page has it, with an arm beside."""
    scene = Scene3D()
    scale = ColorScale("Height", "mm", 0, 100)
    vertices, faces = mug(n_faces)
    heights_mm = 1000 * vertices[:, 2]
    scene.set_prepared_mesh(
        "object", prepare_mesh(vertices, faces, values=heights_mm, scale=scale, is_shaded=True)
    )
    scene.set_ground("ground", (0, 0, 0), (0.4, 0.4), vertices)
    scene.set_arm("arm", UR5, _JOINTS_RAD)
    scene.set_pose("arm", make_pose(np.eye(3), (-0.55, 0, 0)))
    candy = candy_mesh(Parameters().particle)
    scene.set_candies("candies", N_CANDIES, (candy.vertices_m, candy.faces), np.arange(N_CANDIES) % 3 > 0)
    scene.show_scale(scale)
    scene.fit("object")
    return scene


def mug(n_faces: int) -> Shape:
    """A cup of about that many faces."""
    sides = max(int((n_faces / 4) ** 0.5) * 2, 8)
    steps = np.linspace(0, 1, n_faces // (4 * sides) + 2)
    inside = [(0.0, 0.005), *((0.036 + 0.002 * t, 0.005 + 0.09 * t) for t in steps)]
    outside = [(0.042, 0.095 * (1 - t)) for t in steps]
    return revolved_mesh([*inside, *outside, (0.0, 0.0)], sides)


def frame_seconds(scene: Scene3D, n_frames: int) -> list[float]:
    """Seconds from setting the positions to the picture on the screen, for each frame."""
    scene.show()
    spot = falling()
    for _ in range(5):
        draw(scene, next(spot))
    seconds = []
    for _ in range(n_frames):
        start = time.perf_counter()
        draw(scene, next(spot))
        seconds.append(time.perf_counter() - start)
    return seconds


def draw(scene: Scene3D, positions_m: FloatArray) -> None:
    """Show candies there and wait for the picture."""
    waiting = QEventLoop()
    view = scene.findChild(SceneView)
    view.painted.connect(waiting.quit)
    scene.set_candy_poses("candies", positions_m, _TURNS)
    waiting.exec()
    view.painted.disconnect(waiting.quit)


def falling() -> Iterator[FloatArray]:
    """Positions (N, 3) of candies that rain into a cup."""
    random = np.random.default_rng(0)
    positions = random.uniform((-0.04, -0.04, 0.0), (0.04, 0.04, 0.2), (N_CANDIES, 3))
    while True:
        positions[:, 2] = 0.01 + (positions[:, 2] - 0.013) % 0.2
        yield positions


if __name__ == "__main__":
    raise SystemExit(main())
