"""Cameras and arms with one fault each, around the simulated ones; and small cells to scan with them."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
import numpy.typing as npt

from core.progress import Reporter
from hardware.cell import Cell, CellSettings, open_cell, read_cell
from hardware.errors import CameraError, CameraLost
from hardware.interfaces import Camera, CameraImage, Move, Robot, RobotState
from hardware.scanning.control import ScanControl
from hardware.scanning.procedure import ScanProcedure, ViewTaken
from hardware.scanning.store import ScanStore
from hardware.scanning.views import PlannedView, name_views
from hardware.simulation.world import World

ORIGIN = {"object": "mug", "seed": 3}
SEED = 3
Where = Callable[[], bool]


class Listening(Reporter):
    """Collects what is told."""

    def __init__(self) -> None:
        super().__init__()
        self.warnings: list[str] = []
        self.done: list[float] = []

    def progress(self, stage: str, done: float, total: float) -> None:
        assert stage == "scan"
        self.done.append(done)

    def warn(self, sentence: str) -> None:
        self.warnings.append(sentence)


class WrappedCamera:
    """The camera inside, unless a fault says otherwise."""

    def __init__(self, inside: Camera) -> None:
        self.name = inside.name
        self.n_captures = 0
        self.n_entered = 0
        self._inside = inside

    def __enter__(self) -> WrappedCamera:
        self.n_entered += 1
        self._inside.__enter__()
        return self

    def __exit__(self, *error: object) -> None:
        self._inside.__exit__(None, None, None)

    def capture(self) -> CameraImage:
        self.n_captures += 1
        return self._inside.capture()


class UnpluggedCamera(WrappedCamera):
    """Goes after a number of images; comes back when it is connected again, or never."""

    def __init__(self, inside: Camera, after: int, comes_back: bool) -> None:
        super().__init__(inside)
        self._after = after
        self._comes_back = comes_back
        self._is_there = True

    def __enter__(self) -> WrappedCamera:
        if not self._is_there and not self._comes_back:
            raise CameraLost("There is no camera; plug it in.")
        self._is_there = True
        return super().__enter__()

    def capture(self) -> CameraImage:
        if self.n_captures == self._after:
            self._is_there = False
            self._after = -1
        if not self._is_there:
            raise CameraLost("The camera was unplugged; plug it in.")
        return super().capture()


class SlowCamera(WrappedCamera):
    """No image in time, in some places, a number of times."""

    def __init__(self, inside: Camera, where: Where, times: int) -> None:
        super().__init__(inside)
        self._where = where
        self._times = times

    def capture(self) -> CameraImage:
        if self._times and self._where():
            self._times -= 1
            self.n_captures += 1
            raise CameraError("The camera sent no image within 2 s; look at its cable.")
        return super().capture()


class BlindCamera(WrappedCamera):
    """All depths are zero in some places."""

    def __init__(self, inside: Camera, where: Where) -> None:
        super().__init__(inside)
        self._where = where

    def capture(self) -> CameraImage:
        image = super().capture()
        return replace(image, depth_m=np.zeros_like(image.depth_m)) if self._where() else image


class FrozenCamera(WrappedCamera):
    """Gives the image before again, in some places, a number of times."""

    def __init__(self, inside: Camera, where: Where, times: int) -> None:
        super().__init__(inside)
        self._where = where
        self._times = times
        self._old: CameraImage | None = None

    def capture(self) -> CameraImage:
        if self._old is not None and self._times and self._where():
            self._times -= 1
            self.n_captures += 1
            return self._old
        self._old = super().capture()
        return self._old


class WatchedRobot:
    """The arm inside; somebody looks before each of its moves and after each has begun."""

    def __init__(
        self,
        inside: Robot,
        before: Callable[[int], None] = lambda _: None,
        begun: Callable[[int], None] = lambda _: None,
    ) -> None:
        self.name = inside.name
        self.n_moves = 0
        self._inside = inside
        self._before = before
        self._begun = begun

    def __enter__(self) -> WatchedRobot:
        self._inside.__enter__()
        return self

    def __exit__(self, *error: object) -> None:
        self._inside.__exit__(None, None, None)

    def state(self) -> RobotState:
        return self._inside.state()

    def move_joints(self, path_rad: npt.ArrayLike, speed_rad_s: float, acceleration_rad_s2: float) -> Move:
        self._before(self.n_moves)
        move = self._inside.move_joints(path_rad, speed_rad_s, acceleration_rad_s2)
        self._begun(self.n_moves)
        self.n_moves += 1
        return move

    def stop(self) -> None:
        self._inside.stop()


def small_cell(chosen: Sequence[int] = (0, 2, 8, 12), is_instant: bool = True) -> CellSettings:
    """The shipped cell with a few of its views."""
    cell = read_cell()
    views = tuple(cell.scan.views_rad[k] for k in chosen)
    return cell.model_copy(
        update={
            "scan": cell.scan.model_copy(update={"views_rad": views, "settle_s": 0.05}),
            "simulation": cell.simulation.model_copy(update={"is_instant": is_instant}),
        }
    )


def at_view(cell: Cell, index: int) -> Where:
    """Tell whether the arm stands at one of the cell's views."""
    joints = np.array(cell.settings.scan.views_rad[index])
    return lambda: bool(np.abs(cell.robot.state().joints_rad - joints).max() < 1e-6)


def planned(settings: CellSettings) -> tuple[PlannedView, ...]:
    return name_views(settings.scan.views_rad)


def scan_into(
    folder: Path | None,
    world: World,
    change: Callable[[Cell], None] = lambda _: None,
    settings: CellSettings | None = None,
    reporter: Reporter | None = None,
    control: ScanControl | None = None,
    taken: ViewTaken | None = None,
) -> ScanProcedure:
    """Begin or continue a scan with some device changed, and take all views; it is left when it fails."""
    settings = settings or small_cell()
    cell = open_cell(settings, world, SEED)
    change(cell)
    store = None if folder is None else ScanStore(folder, ORIGIN)
    with cell:
        procedure = ScanProcedure(cell, store, reporter or Listening(), control, taken)
        procedure.take(planned(settings))
    return procedure


def contents(folder: Path) -> dict[str, bytes]:
    """All files of a folder, by their name in it."""
    files = sorted(path for path in folder.rglob("*") if path.is_file())
    return {str(path.relative_to(folder)): path.read_bytes() for path in files}
