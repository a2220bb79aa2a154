"""Pictures to MP4: H.264, yuv420p, index in front, through the ffmpeg that imageio-ffmpeg brings."""

from __future__ import annotations

import contextlib
import subprocess
import tempfile
from collections.abc import Iterable
from pathlib import Path
from typing import BinaryIO

import imageio_ffmpeg

from core.errors import StageError
from core.imagination.rendering.scene import Picture

_QUALITY = ("-preset", "veryfast", "-crf", "23", "-threads", "1")


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
    raw = [
        "-f",
        "rawvideo",
        "-pix_fmt",
        "rgb24",
        "-s",
        "{}x{}".format(*size_px),
        "-r",
        str(rate_hz),
        "-i",
        "-",
    ]
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
        ffmpeg.stdin.close()
