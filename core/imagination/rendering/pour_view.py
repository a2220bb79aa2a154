"""A pour made visible: the object, the cup through which one sees, the candies by their fate."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from core.geometry import FloatArray, transform_points
from core.imagination.particle_shape import particle_extents_m
from core.imagination.recording import Recording
from core.imagination.rendering.camera import Camera, aabb_corners, frame
from core.imagination.rendering.replay import Replay, make_replay, poured_in
from core.imagination.rendering.scene import OBJECT_COLOR, Picture, Scene
from core.mesh import TriangleMesh
from core.parameters import Parameters

_GROUND_GAP_M = 0.0005


@dataclass(frozen=True)
class PourView:
    """An open scene of pours; `camera` is the same for all of them."""

    scene: Scene
    cup_id: int | None
    camera: Camera

    def shoot(self, replay: Replay, moment: int, width: int, height: int) -> Picture:
        """Take the picture (height, width, 3) of a recorded moment of a pour."""
        recording = replay.recording
        if self.cup_id is not None:
            self.scene.move_mesh(self.cup_id, recording.T_world_body[moment])
        self.scene.move_candies(recording.positions_m[moment], recording.quaternions[moment], replay.retained)
        return self.scene.photograph(self.camera, width, height)


@contextmanager
def open_pours(
    folder: Path,
    surface: TriangleMesh,
    cup: TriangleMesh | None,
    cup_poses: Sequence[FloatArray],
    parameters: Parameters,
    aspect: float,
    with_egl: bool,
) -> Iterator[PourView]:
    """Open the scene of pours whose cup stands at `cup_poses` (4, 4); `folder` takes temporary files."""
    aabb = np.array([surface.aabb_min_m, surface.aabb_max_m])
    points = [aabb_corners(*aabb)]
    with Scene(folder, aabb, with_egl) as scene:
        scene.add_ground(aabb[0, 2] - _GROUND_GAP_M)
        scene.add_mesh(surface, OBJECT_COLOR)
        # Any candy may turn out kept or lost, so there are enough of both colours.
        scene.add_candies(parameters.particle, parameters.pouring.n_pour, parameters.pouring.n_pour)
        cup_id = None
        if cup is not None:
            cup_id = scene.add_cup(cup)
            points += [transform_points(pose, cup.vertices_m) for pose in cup_poses]
        yield PourView(scene, cup_id, frame(np.vstack(points), scene.forward, aspect))


def pour_replay(
    recording: Recording, surface: TriangleMesh, aabb_m: FloatArray, parameters: Parameters
) -> Replay:
    """Prepare a pour's recording; `aabb_m` (2, 3) is the one its candies were counted in."""
    retained = poured_in(recording, aabb_m, parameters.pouring.counted)
    candy_height_m = float(particle_extents_m(parameters.particle)[2])
    return make_replay(recording, retained, float(surface.aabb_min_m[2]) - _GROUND_GAP_M, candy_height_m)
