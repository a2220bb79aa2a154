"""Films of the drop and of the chosen pour, in real time, as MP4 that every browser plays."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from math import degrees
from pathlib import Path

import numpy as np

from core.geometry import FloatArray
from core.imagination.recording import Recording
from core.imagination.rendering.drop_view import open_drop, phase
from core.imagination.rendering.evidence import Evidence
from core.imagination.rendering.labels import BAR_PX, with_caption
from core.imagination.rendering.movie import encode
from core.imagination.rendering.pour_view import open_pours, pour_replay
from core.imagination.rendering.scene import EGL, Picture, Scene
from core.imagination.results import Containability, PourChoice, PourGrid
from core.mesh import TriangleMesh
from core.parameters import Parameters
from core.workers import report_fraction

_RATE_HZ = 24
_SLOW_RATE_HZ = 12
"""For TinyRenderer, which takes several times as long for a picture, and for slow motion."""
_HOLD_S = 1.0


def render_drop_film(
    folder: Path,
    surface: TriangleMesh,
    containability: Containability,
    parameters: Parameters,
    size_px: tuple[int, int],
    with_egl: bool,
) -> Evidence:
    """Return the film of the drop as `drop.mp4`; sizes are even. Call it in a worker."""
    width, height = size_px[0], size_px[1] - BAR_PX
    recording = containability.recording

    with open_drop(folder, surface, containability, parameters, width / height, with_egl) as view:

        def shoot(moment: int) -> Picture:
            time_s = float(recording.time_s[moment])
            words = phase(parameters.containability, time_s)
            return with_caption(view.shoot(moment, width, height), f"{time_s:.1f} s   {words}")

        rate_hz = film_rate_hz(view.scene)
        moments = film_moments(recording, rate_hz, calm_from_s=parameters.containability.drop_s)
        film = encode(folder, _play(moments, shoot), size_px, rate_hz)
        return Evidence({"drop.mp4": film}, view.scene.renderer)


def render_pour_film(
    folder: Path,
    surface: TriangleMesh,
    aabb_m: FloatArray,
    cup: TriangleMesh | None,
    grid: PourGrid,
    choice: PourChoice,
    parameters: Parameters,
    size_px: tuple[int, int],
    with_egl: bool,
) -> Evidence:
    """Return the film of the chosen pour as `pour.mp4`; sizes are even. Call it in a worker.

    `aabb_m` (2, 3) is the AABB the candies were counted in.
    """
    width, height = size_px[0], size_px[1] - BAR_PX
    recording = grid.recordings[choice.i][choice.j]
    poses = list(recording.T_world_body.astype(float))
    words = f"from {degrees(choice.theta_rad) % 360:.0f}°, indent {1000 * grid.indent_m[choice.j]:.0f} mm"
    replay = pour_replay(recording, surface, aabb_m, parameters)
    with open_pours(folder, surface, cup, poses, parameters, width / height, with_egl) as view:

        def shoot(moment: int) -> Picture:
            picture = view.shoot(replay, moment, width, height)
            return with_caption(picture, f"{recording.time_s[moment]:.1f} s   {words}")

        rate_hz = film_rate_hz(view.scene)
        moments = film_moments(recording, rate_hz, calm_from_s=float("inf"))
        film = encode(folder, _play(moments, shoot), size_px, rate_hz)
        return Evidence({"pour.mp4": film}, view.scene.renderer)


def film_rate_hz(scene: Scene) -> int:
    """Frames per second that the scene's renderer can afford."""
    return _RATE_HZ if scene.renderer == EGL else _SLOW_RATE_HZ


def film_moments(recording: Recording, rate_hz: int, calm_from_s: float) -> list[int]:
    """Return the recorded moment of each frame in real time; the calm part is drawn at `_SLOW_RATE_HZ`."""
    times_s = np.arange(0, float(recording.time_s[-1]) + 0.5 / rate_hz, 1 / rate_hz)
    slow_times_s = np.floor(times_s * _SLOW_RATE_HZ + 1e-6) / _SLOW_RATE_HZ
    times_s = np.where(times_s < calm_from_s, times_s, slow_times_s)
    moments = np.abs(recording.time_s[None, :] - times_s[:, None]).argmin(axis=1)
    last = len(recording.time_s) - 1
    return [*moments.tolist(), *[last] * round(_HOLD_S * rate_hz)]


def _play(moments: list[int], shoot: Callable[[int], Picture]) -> Iterator[Picture]:
    """Yield the pictures of a film; a moment that stays is drawn once."""
    shown, picture = -1, np.empty(0, dtype=np.uint8)
    for index, moment in enumerate(moments):
        report_fraction(index / len(moments))
        if moment != shown:
            shown, picture = moment, shoot(moment)
        yield picture
