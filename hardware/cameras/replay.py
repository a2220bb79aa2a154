"""A recorded scan, played as a camera."""

from __future__ import annotations

import time
from collections.abc import Iterator
from pathlib import Path

from core.geometry import FloatArray
from core.progress import Reporter
from core.scan.authors_layout import read_scan
from core.scan.model import Intrinsics, RgbdFrame
from hardware.errors import CameraLost
from hardware.interfaces import CameraImage

_SESSION_SCAN = "scan"


class ReplayCamera:
    """Gives the views of a scan one after the other; entering begins with the first.

    Attributes:
        name: says which folder is played.
        T_base_camera: (4, 4) where the last image was taken from; None before the first.
        n_views: how many there are, once entered.
    """

    def __init__(self, folder: Path) -> None:
        """Choose the scan: a session, the scan in one, or a folder in the authors' layout."""
        self.name = f"replay of {folder}"
        self.T_base_camera: FloatArray | None = None
        self.n_views = 0
        self._folder = folder
        self._views: Iterator[RgbdFrame] | None = None
        self._intrinsics: Intrinsics

    def __enter__(self) -> ReplayCamera:
        """Read the scan. Views that say nothing are left out, as on every import.

        Raises:
            InputError: a file is missing or cannot be used; the sentence names it.
        """
        recorded = self._folder / _SESSION_SCAN
        scan = read_scan(recorded if recorded.is_dir() else self._folder, Reporter())
        self._intrinsics = scan.intrinsics
        self._views = iter(scan.frames)
        self.n_views = len(scan.frames)
        self.T_base_camera = None
        return self

    def __exit__(self, *exception: object) -> None:
        """Forget the views."""
        self._views = None

    def capture(self) -> CameraImage:
        """Return the next view, dated now on the computer's monotonic clock.

        Raises:
            CameraLost: all views were given, or the camera was not entered.
        """
        if self._views is None:
            raise CameraLost(f"The {self.name} is not running; connect it first.")
        view = next(self._views, None)
        if view is None:
            raise CameraLost(f"The {self.name} has ended; connect it again to play it anew.")
        self.T_base_camera = view.T_base_camera
        return CameraImage(view.color, view.depth_m, self._intrinsics, time.monotonic())
