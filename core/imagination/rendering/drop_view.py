"""The drop made visible: its scene, its camera over time, its phases in words, and six stills of it."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from math import degrees
from pathlib import Path

import numpy as np

from core.geometry import FloatArray
from core.imagination.particle_shape import particle_extents_m
from core.imagination.recording import Recording
from core.imagination.rendering.camera import Camera, aabb_corners, frame
from core.imagination.rendering.evidence import Evidence, show_early
from core.imagination.rendering.pictures import SUPERSAMPLING, VIEW_PX, reduced, to_png, with_caption
from core.imagination.rendering.replay import Replay, make_replay, standing
from core.imagination.rendering.scene import OBJECT_COLOR, Picture, Scene
from core.imagination.results import Containability
from core.mesh import TriangleMesh
from core.parameters import Parameters
from core.parameters.imagination import ContainabilityParameters
from core.workers import report_fraction

_GROUND_GAP_M = 0.0005
_SURROUNDINGS = 0.25


@dataclass(frozen=True)
class DropView:
    """An open scene of the drop; `wide` sees the candies in the air, `near` what lies by the object."""

    scene: Scene
    object_id: int
    replay: Replay
    wide: Camera
    near: Camera
    near_from_s: float

    def shoot(self, moment: int, width: int, height: int) -> Picture:
        """Take the picture (height, width, 3) of a recorded moment; the camera moves closer as they fall."""
        recording = self.replay.recording
        self.scene.move_mesh(self.object_id, recording.T_world_body[moment])
        self.scene.move_candies(
            recording.positions_m[moment], recording.quaternions[moment], self.replay.retained
        )
        share = min(float(recording.time_s[moment]) / max(self.near_from_s, 1e-6), 1.0)
        eased = share * share * (3 - 2 * share)
        return self.scene.photograph(self.wide.blended(self.near, eased), width, height)


@contextmanager
def open_drop(
    folder: Path,
    surface: TriangleMesh,
    containability: Containability,
    parameters: Parameters,
    with_egl: bool,
) -> Iterator[DropView]:
    """Open the scene of a drop; files that Bullet reads go to `folder` as long as it is open."""
    aabb = np.array([surface.aabb_min_m, surface.aabb_max_m])
    recording, ground_m = standing(containability.recording, surface)
    ground_m -= _GROUND_GAP_M
    extents_m = particle_extents_m(parameters.particle)
    replay = make_replay(recording, containability.retained, ground_m, extents_m)
    with Scene(folder, aabb, with_egl) as scene:
        scene.add_ground(ground_m)
        object_id = scene.add_mesh(surface, OBJECT_COLOR)
        scene.add_candies(
            parameters.particle, containability.n_in, containability.n_drop - containability.n_in
        )
        near_points = _near_points(aabb, replay)
        wide_points = np.vstack([near_points, containability.drop_positions_m])
        yield DropView(
            scene,
            object_id,
            replay,
            frame(wide_points, scene.forward, VIEW_PX[0] / VIEW_PX[1]),
            frame(near_points, scene.forward, VIEW_PX[0] / VIEW_PX[1]),
            parameters.containability.drop_s,
        )


def phase(settings: ContainabilityParameters, time_s: float) -> str:
    """Return what happens to the object at a time."""
    amplitude = f"{degrees(settings.rotation_rad):.3g}°"
    since = time_s - settings.drop_s
    if since < 0:
        return "falling"
    if since < 2 * settings.rotation_s:
        return f"rotating {amplitude} about {'x' if since < settings.rotation_s else 'y'}"
    pushes = since - 2 * settings.rotation_s
    if pushes < 4 * settings.translation_s:
        return "pushed along " + ("+x", "-x", "+y", "-y")[int(pushes / settings.translation_s)]
    return "end"


def _near_points(aabb_m: FloatArray, replay: Replay) -> FloatArray:
    """The object and the lost candies that lie close by."""
    final = replay.recording.positions_m[-1]
    margin_m = _SURROUNDINGS * np.linalg.norm(aabb_m[1] - aabb_m[0])
    with np.errstate(invalid="ignore"):
        is_close = ((final > aabb_m[0] - margin_m) & (final < aabb_m[1] + margin_m)).all(axis=1)
    return np.vstack([aabb_corners(*aabb_m), final[is_close].astype(float)])


def render_drop_stills(
    folder: Path,
    surface: TriangleMesh,
    containability: Containability,
    parameters: Parameters,
    with_egl: bool,
    early: Path | None = None,
) -> Evidence:
    """Return PNGs of `PICTURE_PX` named `drop_1_start.png` to `drop_6_end.png`.

    Call it in a worker; `folder` takes temporary files, `early` each picture as soon as it is drawn.
    """
    width, height = VIEW_PX
    moments = still_moments(containability.recording, parameters)
    files = {}
    with open_drop(folder, surface, containability, parameters, with_egl) as view:
        for index, (name, moment) in enumerate(moments.items()):
            report_fraction(index / len(moments))
            large = view.shoot(moment, SUPERSAMPLING * width, SUPERSAMPLING * height)
            time_s = float(containability.recording.time_s[moment])
            caption = f"{time_s:.2f} s   {_words(name, time_s, containability, parameters)}"
            file = f"drop_{index + 1}_{name}.png"
            files[file] = to_png(with_caption(reduced(large), caption))
            show_early(early, file, files[file])
        return Evidence(files, view.scene.renderer)


def still_moments(recording: Recording, parameters: Parameters) -> dict[str, int]:
    """Pick the recorded moment of each still."""
    settings = parameters.containability
    settled_s = settings.drop_s
    pushes_s = settled_s + 2 * settings.rotation_s
    times_s = {
        "start": 0.0,
        "falling": _mostly_fallen_s(recording, settled_s),
        "settled": settled_s,
        "rotated": settled_s + settings.rotation_s / 4,
        "pushed": pushes_s + 0.9 * settings.translation_s,
        "end": float(recording.time_s[-1]),
    }
    return {name: int(np.abs(recording.time_s - time_s).argmin()) for name, time_s in times_s.items()}


def _mostly_fallen_s(recording: Recording, settled_s: float) -> float:
    """When the candies that stay on the object have three quarters of their fall behind them, on average."""
    until = int(np.abs(recording.time_s - settled_s).argmin())
    heights = recording.positions_m[: until + 1, :, 2]
    landed = heights[:, np.isfinite(heights[-1])]
    if landed.shape[1] == 0:
        return settled_s / 4
    mean = landed.mean(axis=1)
    return float(recording.time_s[np.abs(mean - (0.25 * mean[0] + 0.75 * mean[-1])).argmin()])


def _words(name: str, time_s: float, containability: Containability, parameters: Parameters) -> str:
    if name == "start":
        return f"start: {containability.n_drop} candies"
    if name == "settled":
        return name
    if name == "end":
        return f"end: {containability.n_in} of {containability.n_drop} kept"
    return phase(parameters.containability, time_s)
