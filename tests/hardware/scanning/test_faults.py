"""One camera fault at a time: the scan goes on, or ends with a sentence and keeps what it has."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

from core.errors import Remedy, StageError
from hardware.cell import Cell
from hardware.errors import CameraLost
from hardware.scanning.procedure import ScanProcedure
from hardware.scanning.store import read_views
from hardware.scanning.views import ViewState
from hardware.simulation.world import World
from tests.hardware.scanning.faulty import (
    BlindCamera,
    FrozenCamera,
    Listening,
    SlowCamera,
    UnpluggedCamera,
    WrappedCamera,
    at_view,
    contents,
    scan_into,
    small_cell,
)

VIEWS = 4
TRIES = small_cell().scan.tries
OTHERS_TAKEN = [ViewState.TAKEN, ViewState.FAILED, ViewState.TAKEN, ViewState.TAKEN]


def scan_with(
    make: Callable[[Cell], WrappedCamera], folder: Path, world: World, reporter: Listening | None = None
) -> tuple[ScanProcedure, WrappedCamera]:
    cameras: list[WrappedCamera] = []

    def change(cell: Cell) -> None:
        cameras.append(make(cell))
        cell.camera = cameras[0]

    return scan_into(folder, world, change, reporter=reporter), cameras[0]


def states(folder: Path) -> list[ViewState]:
    return [record.state for record in read_views(folder)]


def test_unplugged_for_good_the_views_are_kept(
    world: World, tmp_path: Path, undisturbed: dict[str, bytes]
) -> None:
    with pytest.raises(CameraLost, match="There is no camera; plug it in"):
        scan_with(lambda cell: UnpluggedCamera(cell.camera, after=2, comes_back=False), tmp_path, world)
    assert states(tmp_path) == [ViewState.TAKEN] * 2 + [ViewState.PENDING] * 2
    scan_into(tmp_path, world)
    assert contents(tmp_path) == undisturbed


def test_unplugged_and_back_the_scan_completes(
    world: World, tmp_path: Path, undisturbed: dict[str, bytes]
) -> None:
    reporter = Listening()
    _, camera = scan_with(
        lambda cell: UnpluggedCamera(cell.camera, after=2, comes_back=True), tmp_path, world, reporter
    )
    assert camera.n_entered == 2
    assert reporter.warnings == []
    assert contents(tmp_path) == undisturbed


@pytest.mark.parametrize("times", [1, TRIES - 1])
def test_an_image_that_comes_late_is_asked_for_again(
    times: int, world: World, tmp_path: Path, undisturbed: dict[str, bytes]
) -> None:
    _, camera = scan_with(lambda cell: SlowCamera(cell.camera, at_view(cell, 1), times), tmp_path, world)
    assert camera.n_captures == VIEWS + times
    assert camera.n_entered == 1 + times
    assert contents(tmp_path) == undisturbed


def test_images_that_never_come_at_one_view_leave_it_out(
    world: World, tmp_path: Path, undisturbed: dict[str, bytes]
) -> None:
    reporter = Listening()
    procedure, camera = scan_with(
        lambda cell: SlowCamera(cell.camera, at_view(cell, 1), 1000), tmp_path, world, reporter
    )
    assert camera.n_captures == VIEWS - 1 + TRIES
    assert states(tmp_path) == OTHERS_TAKEN
    assert reporter.warnings == [
        "View frame-000001 is left out: The camera sent no image within 2 s; look at its cable."
    ]
    assert len(procedure.scan().frames) == 3
    assert not list((tmp_path / "rgbd").glob("frame-000001*"))
    # The same command tries it again, and only it.
    scan_into(tmp_path, world)
    assert contents(tmp_path) == undisturbed


def test_no_depth_at_one_view_leaves_it_out(world: World, tmp_path: Path) -> None:
    reporter = Listening()
    _, camera = scan_with(lambda cell: BlindCamera(cell.camera, at_view(cell, 1)), tmp_path, world, reporter)
    assert camera.n_captures == VIEWS - 1 + TRIES
    assert states(tmp_path) == OTHERS_TAKEN
    [said] = reporter.warnings
    assert said.startswith("View frame-000001 is left out: frame-000001 has no depth at all;")


def test_a_frozen_image_is_asked_for_again(
    world: World, tmp_path: Path, undisturbed: dict[str, bytes]
) -> None:
    _, camera = scan_with(lambda cell: FrozenCamera(cell.camera, at_view(cell, 1), 1), tmp_path, world)
    assert camera.n_captures == VIEWS + 1
    assert states(tmp_path) == [ViewState.TAKEN] * VIEWS
    assert contents(tmp_path) == undisturbed


def test_an_image_that_stays_frozen_leaves_the_view_out(world: World, tmp_path: Path) -> None:
    reporter = Listening()
    _, camera = scan_with(
        lambda cell: FrozenCamera(cell.camera, at_view(cell, 1), 1000), tmp_path, world, reporter
    )
    assert camera.n_captures == VIEWS - 1 + TRIES
    assert states(tmp_path) == OTHERS_TAKEN
    [said] = reporter.warnings
    assert said.startswith("View frame-000001 is left out: frame-000001 repeats the previous image")


def test_a_camera_that_hangs_for_good_ends_the_scan_with_its_first_view(world: World, tmp_path: Path) -> None:
    with pytest.raises(
        StageError, match=r"3 views failed .* the camera is frozen\. What was taken before \(views: 1\)"
    ):
        scan_with(lambda cell: FrozenCamera(cell.camera, lambda: True, 1000), tmp_path, world)
    assert states(tmp_path) == [ViewState.TAKEN] + [ViewState.FAILED] * 3


@pytest.mark.parametrize("kind", ["slow", "blind"])
def test_three_failures_in_a_row_end_the_scan(
    kind: str, world: World, tmp_path: Path, undisturbed: dict[str, bytes]
) -> None:
    reason = {"slow": "sent no image within 2 s", "blind": "has no depth at all"}[kind]

    def make(cell: Cell) -> WrappedCamera:
        is_first = at_view(cell, 0)
        if kind == "slow":
            return SlowCamera(cell.camera, lambda: not is_first(), 1000)
        return BlindCamera(cell.camera, lambda: not is_first())

    with pytest.raises(StageError, match=reason) as ended:
        scan_with(make, tmp_path, world)
    said = str(ended.value)
    assert said.startswith("3 views failed one after the other, the last because:")
    assert "(views: 1) is kept" in said
    assert ended.value.remedy is Remedy.CONTINUE
    assert states(tmp_path) == [ViewState.TAKEN] + [ViewState.FAILED] * 3
    if kind == "slow":
        scan_into(tmp_path, world)
        assert contents(tmp_path) == undisturbed


def test_failures_that_are_not_in_a_row_do_not_end_it(world: World, tmp_path: Path) -> None:
    chosen = (0, 2, 4, 6, 8, 12, 14)

    def make(cell: Cell) -> None:
        bad = [at_view(cell, k) for k in (0, 1, 3, 4)]
        cell.camera = SlowCamera(cell.camera, lambda: any(is_bad() for is_bad in bad), 1000)

    procedure = scan_into(tmp_path, world, make, settings=small_cell(chosen))
    assert [record.has_image for record in procedure.records] == [
        False,
        False,
        True,
        False,
        False,
        True,
        True,
    ]


def test_a_view_whose_retake_fails_keeps_its_old_image(world: World, tmp_path: Path) -> None:
    reporter = Listening()
    camera: list[SlowCamera] = []

    def change(cell: Cell) -> None:
        camera.append(SlowCamera(cell.camera, lambda: True, 0))
        cell.camera = camera[0]

    procedure = scan_into(tmp_path, world, change, reporter=reporter)
    before = contents(tmp_path)
    camera[0]._times = 1000
    procedure.retake(["frame-000002"])
    assert contents(tmp_path) == before
    [said] = reporter.warnings
    assert said.startswith("View frame-000002 keeps its old image: The camera sent no image")
    assert len(procedure.scan().frames) == VIEWS
