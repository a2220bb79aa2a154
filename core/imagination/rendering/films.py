"""Films of the drop and of the chosen pour, in real time, as MP4 that every browser plays.

H.264, yuv420p, index in front, through the ffmpeg that imageio-ffmpeg brings.
"""

from __future__ import annotations

import contextlib
import subprocess
import tempfile
from collections.abc import Callable, Iterable, Iterator
from math import degrees
from pathlib import Path
from typing import BinaryIO

import imageio_ffmpeg
import numpy as np

from core.errors import StageError
from core.geometry import FloatArray
from core.imagination.recording import Recording
from core.imagination.rendering.drop_view import open_drop, phase
from core.imagination.rendering.evidence import Evidence
from core.imagination.rendering.pictures import PICTURE_PX, VIEW_PX, with_caption
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
_QUALITY = ("-preset", "veryfast", "-crf", "23", "-threads", "1")


def render_drop_film(
    folder: Path,
    surface: TriangleMesh,
    containability: Containability,
    parameters: Parameters,
    with_egl: bool,
) -> Evidence:
    """Return the film of the drop as `drop.mp4`. Call it in a worker."""
    recording, settings = containability.recording, parameters.containability
    with open_drop(folder, surface, containability, parameters, with_egl) as view:

        def shoot(moment: int) -> tuple[Picture, str]:
            return view.shoot(moment, *VIEW_PX), phase(settings, float(recording.time_s[moment]))

        film = _film(folder, view.scene, recording, shoot, settings.drop_s)
        return Evidence({"drop.mp4": film}, view.scene.renderer)


def render_pour_film(
    folder: Path,
    surface: TriangleMesh,
    aabb_m: FloatArray,
    cup: TriangleMesh | None,
    grid: PourGrid,
    choice: PourChoice,
    parameters: Parameters,
    with_egl: bool,
) -> Evidence:
    """Return the film of the chosen pour as `pour.mp4`. Call it in a worker.

    `aabb_m` (2, 3) is the AABB the candies were counted in.
    """
    recording = grid.recordings[choice.i][choice.j]
    poses = list(recording.T_world_body.astype(float))
    words = f"from {degrees(choice.theta_rad) % 360:.0f}°, indent {1000 * grid.indent_m[choice.j]:.0f} mm"
    replay = pour_replay(recording, surface, aabb_m, parameters)
    with open_pours(folder, surface, cup, poses, parameters, VIEW_PX[0] / VIEW_PX[1], with_egl) as view:

        def shoot(moment: int) -> tuple[Picture, str]:
            return view.shoot(replay, moment, *VIEW_PX), words

        film = _film(folder, view.scene, recording, shoot, calm_from_s=float("inf"))
        return Evidence({"pour.mp4": film}, view.scene.renderer)


def _film(
    folder: Path,
    scene: Scene,
    recording: Recording,
    shoot: Callable[[int], tuple[Picture, str]],
    calm_from_s: float,
) -> bytes:
    """Film a recording; `shoot` takes the picture of a moment and says what happens in it."""

    def captioned(moment: int) -> Picture:
        picture, words = shoot(moment)
        return with_caption(picture, f"{recording.time_s[moment]:.1f} s   {words}")

    rate_hz = film_rate_hz(scene)
    moments = film_moments(recording, rate_hz, calm_from_s)
    return encode(folder, _play(moments, captioned), PICTURE_PX, rate_hz)


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


def encode(folder: Path, pictures: Iterable[Picture], size_px: tuple[int, int], rate_hz: int) -> bytes:
    """Return the MP4 of pictures (height, width, 3) with even `size_px` (width, height).

    Raises:
        StageError: there is no ffmpeg, or it failed.
    """
    with tempfile.TemporaryDirectory(dir=folder) as place:
        film, log = Path(place) / "film.mp4", Path(place) / "log.txt"
        with log.open("wb") as errors, _started(film, size_px, rate_hz, errors) as ffmpeg:
            try:
                _feed(ffmpeg, pictures)
            except BaseException:
                ffmpeg.kill()
                _close(ffmpeg)
                raise
        if ffmpeg.returncode != 0:
            said = log.read_text(encoding="utf-8", errors="replace").split("\n")
            raise StageError(f"ffmpeg made no film ({said[0]}); set evidence.films=false to go without.")
        return film.read_bytes()


def _started(film: Path, size_px: tuple[int, int], rate_hz: int, errors: BinaryIO) -> subprocess.Popen[bytes]:
    try:
        program = imageio_ffmpeg.get_ffmpeg_exe()
    except RuntimeError as error:
        raise StageError(f"There is no ffmpeg ({error}); set evidence.films=false to go without.") from error
    size = "{}x{}".format(*size_px)
    raw = ["-f", "rawvideo", "-pix_fmt", "rgb24", "-s", size, "-r", str(rate_hz), "-i", "-"]
    coded = ["-c:v", "libx264", "-pix_fmt", "yuv420p", *_QUALITY, "-movflags", "+faststart", str(film)]
    # In a session of its own: Ctrl-C in the terminal must not end it before the worker is asked to stop.
    return subprocess.Popen(
        [program, "-loglevel", "error", *raw, *coded],
        stdin=subprocess.PIPE,
        stdout=subprocess.DEVNULL,
        stderr=errors,
        start_new_session=True,
    )


def _feed(ffmpeg: subprocess.Popen[bytes], pictures: Iterable[Picture]) -> None:
    assert ffmpeg.stdin is not None
    # A broken pipe means that ffmpeg gave up; its log says why.
    with contextlib.suppress(BrokenPipeError):
        for picture in pictures:
            ffmpeg.stdin.write(picture.tobytes())
    _close(ffmpeg)


def _close(ffmpeg: subprocess.Popen[bytes]) -> None:
    """Close its input, whose buffer cannot be flushed to a process that has ended."""
    assert ffmpeg.stdin is not None
    with contextlib.suppress(BrokenPipeError):
        ffmpeg.stdin.close()
