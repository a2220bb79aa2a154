"""A film of the tour: the mug scanned, imagined, and poured into, in a real window on a virtual screen.

Run by `make film`. Waiting is cut where nothing but the job bar changes, the rest is played faster, so that
the film is a minute long at most; a ring shows what is clicked.
"""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import imageio_ffmpeg
from PySide6.QtCore import QObject, QPoint, QPointF, Qt, QTimer
from PySide6.QtGui import QColor, QImage, QPainter, QPen
from PySide6.QtWidgets import QAbstractButton, QWidget

from app.gui.headless_check import Tour, Walk, let_work
from app.gui.main import make_application, open_window
from app.library.places import SESSIONS_VARIABLE

SIZE_PX = (1280, 800)
LONGEST_S = 58.0
_RATE_HZ, _MOST_EQUAL, _EVERY_EQUAL = 8, 8, 24
_BAR_PX = 44
"""The job bar: where only its time left changes, the film hurries on."""
_LOOK_S, _SEE_S, _RING_S, _RING_PX = 1.2, 4.0, 0.8, 22
_POSTER_SHARE = 0.75


class FilmedWalk(Walk):
    """Looks for a moment before it clicks, and remembers where.

    Attributes:
        clicked: on the screen, and when (`time.monotonic`); none at first.
    """

    clicked: tuple[QPoint, float] | None = None

    def click(self, name: str, within_s: float = 5.0) -> None:
        """Click a button, after a look at the page."""
        self.wait(lambda: self.shown(QAbstractButton, name), f"button '{name}'", within_s)
        self._look_at(name)
        super().click(name, within_s)

    def hold(self, name: str, seconds: float) -> None:
        """Hold a button, after a look at the page."""
        self.wait(lambda: self.shown(QWidget, name), f"button '{name}'", 10)
        self._look_at(name)
        super().hold(name, seconds)

    def wait_for_work(self, what: str, within_s: float) -> None:
        """Wait for a job, and see what came of it."""
        super().wait_for_work(what, within_s)
        let_work(_SEE_S)

    def _look_at(self, name: str) -> None:
        let_work(_LOOK_S)
        widget = self.shown(QWidget, name)
        if widget is not None:
            self.clicked = widget.mapToGlobal(widget.rect().center()), time.monotonic()
            let_work(_RING_S / 2)


class Recorder(QObject):
    """Writes what the screen shows, a few times a second, until it is closed.

    Attributes:
        n_frames: written so far.
    """

    def __init__(self, walk: FilmedWalk, path: Path) -> None:
        super().__init__(walk.window)
        self.n_frames = 0
        self._walk = walk
        self._last, self._n_equal = QImage(), 0
        self._ffmpeg = _encoder("-crf", "8", "-preset", "ultrafast", str(path))
        self._timer = QTimer(self, interval=1000 // _RATE_HZ)
        self._timer.timeout.connect(self._take)
        self._timer.start()

    def close(self) -> None:
        """Finish the file."""
        self._timer.stop()
        assert self._ffmpeg.stdin is not None
        self._ffmpeg.stdin.close()
        self._ffmpeg.wait()

    def _take(self) -> None:
        image = (
            self._walk.window.screen().grabWindow(0).toImage().convertToFormat(QImage.Format.Format_RGB888)
        )
        self._n_equal = self._n_equal + 1 if image == self._last else 0
        self._last = image
        if self._n_equal < _MOST_EQUAL:
            self.n_frames += 1
            assert self._ffmpeg.stdin is not None
            shown = _ringed(image, self._walk.clicked)  # Its bits are its own: it must outlive the writing.
            self._ffmpeg.stdin.write(shown.constBits())


def _ringed(image: QImage, clicked: tuple[QPoint, float] | None) -> QImage:
    if clicked is None or time.monotonic() - clicked[1] > _RING_S:
        return image
    ringed = image.copy()
    painter = QPainter(ringed)
    painter.setRenderHint(QPainter.RenderHint.Antialiasing)
    painter.setPen(QPen(QColor("#d98a00"), 4))
    painter.setBrush(Qt.BrushStyle.NoBrush)
    painter.drawEllipse(QPointF(clicked[0]), _RING_PX, _RING_PX)
    painter.end()
    return ringed


def _encoder(*coded: str) -> subprocess.Popen[bytes]:
    size = "{}x{}".format(*SIZE_PX)
    raw = ("-f", "rawvideo", "-pix_fmt", "rgb24", "-s", size, "-r", str(_RATE_HZ), "-i", "-")
    return subprocess.Popen(
        [imageio_ffmpeg.get_ffmpeg_exe(), "-y", "-loglevel", "error", *raw, "-c:v", "libx264", *coded],
        stdin=subprocess.PIPE,
    )


def _finish(raw: Path, n_frames: int, film: Path, poster: Path) -> None:
    """Play it fast enough, small enough for a repository, and keep a picture out of it."""
    program = (imageio_ffmpeg.get_ffmpeg_exe(), "-y", "-loglevel", "error", "-i", str(raw))
    factor = min(1.0, LONGEST_S / (n_frames / _RATE_HZ))
    played = ("-vf", f"setpts={factor:.4f}*PTS", "-r", "15", "-c:v", "libx264", "-pix_fmt", "yuv420p")
    small = ("-preset", "slow", "-crf", "30", "-movflags", "+faststart")
    subprocess.run([*program, *played, *small, str(film)], check=True)
    at_s = _POSTER_SHARE * n_frames / _RATE_HZ
    subprocess.run([*program, "-ss", f"{at_s:.1f}", "-frames:v", "1", str(poster)], check=True)
    print(f"{film}: {factor * n_frames / _RATE_HZ:.0f} s, {film.stat().st_size / 1e6:.1f} MB")


def main() -> None:
    """Write `tour.mp4` and `tour.png` into the folder given."""
    target = Path(sys.argv[1])
    target.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory() as home:
        os.environ["XDG_CONFIG_HOME"] = home
        os.environ[SESSIONS_VARIABLE] = f"{home}/sessions"
        window = open_window(make_application())
        window.setGeometry(0, 0, *SIZE_PX)
        walk = FilmedWalk(window)
        recorder = Recorder(walk, Path(home) / "raw.mkv")
        try:
            Tour(walk, print).run()
            let_work(2 * _LOOK_S)
        finally:
            recorder.close()
            window.close_without_asking()
        _finish(Path(home) / "raw.mkv", recorder.n_frames, target / "tour.mp4", target / "tour.png")


if __name__ == "__main__":
    main()
