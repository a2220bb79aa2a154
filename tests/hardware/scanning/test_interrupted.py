"""A scan that ends before its end: every view that was taken is kept, and the same command takes the rest."""

from __future__ import annotations

import errno
import os
import random
import shutil
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from core.errors import SessionError
from core.scan.model import RgbdFrame
from hardware.cell import Cell, open_cell
from hardware.scanning import store
from hardware.scanning.procedure import ScanProcedure
from hardware.scanning.store import ScanStore, read_views
from hardware.scanning.views import ViewState
from hardware.simulation.world import World
from tests.hardware.scanning.faulty import (
    ORIGIN,
    SEED,
    Listening,
    WatchedRobot,
    WrappedCamera,
    contents,
    planned,
    scan_into,
    small_cell,
)

pytestmark = pytest.mark.system

VIEWS = 4


class Interrupted(BaseException):
    """As a kill would: nobody catches it."""


def interrupt_before_move(move: int) -> Callable[[Cell], None]:
    def before(k: int) -> None:
        if k == move:
            raise Interrupted

    def change(cell: Cell) -> None:
        cell.robot = WatchedRobot(cell.robot, before=before)

    return change


def continue_scan(folder: Path, world: World) -> tuple[ScanProcedure, int]:
    """Return the finished scan, and how many images that took."""
    cameras = []

    def count(cell: Cell) -> None:
        cell.camera = WrappedCamera(cell.camera)
        cameras.append(cell.camera)

    procedure = scan_into(folder, world, count)
    return procedure, cameras[0].n_captures


@pytest.mark.parametrize("move", [0, 2])
def test_only_the_missing_views_are_taken(
    move: int, world: World, tmp_path: Path, undisturbed: dict[str, bytes]
) -> None:
    with pytest.raises(Interrupted):
        scan_into(tmp_path, world, interrupt_before_move(move))
    procedure, n_captures = continue_scan(tmp_path, world)
    assert n_captures == VIEWS - move
    assert contents(tmp_path) == undisturbed
    assert [frame.name[-1] for frame in procedure.scan().frames] == ["0", "1", "2", "3"]
    assert len(procedure.volume.mesh().faces) > 500


def test_a_finished_scan_takes_nothing(world: World, tmp_path: Path, undisturbed: dict[str, bytes]) -> None:
    scan_into(tmp_path, world)
    _, n_captures = continue_scan(tmp_path, world)
    assert n_captures == 0
    assert contents(tmp_path) == undisturbed


def test_ended_between_the_images_and_the_note_that_all_are_told(
    world: World, tmp_path: Path, undisturbed: dict[str, bytes]
) -> None:
    """The view is noted with its images already, in its place."""

    class Ending(ScanStore):
        def write_view(self, frame: RgbdFrame, *rest) -> None:
            super().write_view(frame, *rest)
            if frame.name == "frame-000001":
                raise Interrupted

    settings = small_cell()
    with open_cell(settings, world, SEED) as cell, pytest.raises(Interrupted):
        ScanProcedure(cell, Ending(tmp_path, ORIGIN), Listening()).take(planned(settings))
    assert [record.view.name for record in read_views(tmp_path)] == [v.name for v in planned(settings)]
    _, n_captures = continue_scan(tmp_path, world)
    assert n_captures == 2
    assert contents(tmp_path) == undisturbed


def test_a_half_written_view_is_taken_again(
    world: World, tmp_path: Path, undisturbed: dict[str, bytes]
) -> None:
    with pytest.raises(Interrupted):
        scan_into(tmp_path, world, interrupt_before_move(2))
    (tmp_path / "rgbd" / "frame-000002.color.png").write_bytes(b"half a picture")
    (tmp_path / "rgbd" / ".frame-000002.depth.png.part").write_bytes(b"less")
    _, n_captures = continue_scan(tmp_path, world)
    assert n_captures == 2
    assert contents(tmp_path) == undisturbed


@pytest.mark.parametrize(
    "lost", [["frame-000001.pose.txt"], ["frame-000000.color.png", "frame-000001.depth.png"]]
)
def test_a_noted_view_whose_files_are_gone_is_taken_again(
    lost: list[str], world: World, tmp_path: Path, undisturbed: dict[str, bytes]
) -> None:
    with pytest.raises(Interrupted):
        scan_into(tmp_path, world, interrupt_before_move(2))
    for name in lost:
        (tmp_path / "rgbd" / name).unlink()
    _, n_captures = continue_scan(tmp_path, world)
    assert n_captures == 2 + len(lost)
    assert contents(tmp_path) == undisturbed


def test_images_from_before_the_first_note_are_thrown_away(
    world: World, tmp_path: Path, undisturbed: dict[str, bytes]
) -> None:
    (tmp_path / "rgbd").mkdir()
    (tmp_path / "rgbd" / "frame-000000.color.png").write_bytes(b"half a picture")
    scan_into(tmp_path, world)
    assert contents(tmp_path) == undisturbed


def test_views_of_another_scan_are_refused(world: World, tmp_path: Path) -> None:
    with pytest.raises(Interrupted):
        scan_into(tmp_path, world, interrupt_before_move(2))
    before = contents(tmp_path)
    with open_cell(small_cell(), world, SEED) as cell:
        for other in ({"object": "bowl", "seed": 3}, {"object": "mug", "seed": 4}, {}):
            with pytest.raises(
                SessionError, match=r"holds views of another scan \(2, .* discard them"
            ) as refused:
                ScanProcedure(cell, ScanStore(tmp_path, other), Listening())
            assert str(tmp_path) in str(refused.value)
    assert contents(tmp_path) == before
    ScanStore(tmp_path, ORIGIN).remove()
    assert not tmp_path.exists()


@pytest.mark.parametrize(
    "damage",
    [
        ('"views"', '"sights"'),
        ('"taken"', '"stolen"'),
        ('"joints_rad"', '"joints"'),
        ('"name": "frame-000000"', '"nome": 1'),
        ("{", "", 1),
    ],
    ids=["no views", "unknown state", "no joints", "no name", "no table"],
)
def test_a_damaged_list_of_views_is_a_sentence(
    damage: tuple, world: World, tmp_path: Path, undisturbed: dict[str, bytes]
) -> None:
    path = tmp_path / "views.json"
    path.write_text(undisturbed["views.json"].decode().replace(*damage))
    for read in (lambda: scan_into(tmp_path, world), lambda: read_views(tmp_path)):
        with pytest.raises(SessionError, match=r"views\.json") as refused:
            read()
        assert str(refused.value).endswith(".")


def test_kill_9_at_any_view_loses_no_view(
    world: World, tmp_path: Path, undisturbed: dict[str, bytes]
) -> None:
    generator = random.Random(7)
    for last in generator.sample(range(VIEWS), 2):
        folder = tmp_path / f"killed-{last}"
        process = subprocess.Popen(
            [sys.executable, "-m", "tests.hardware.scanning.kept_scan", str(folder)],
            stdout=subprocess.PIPE,
            text=True,
            env=os.environ | {"PYTHONPATH": os.pathsep.join([str(Path.cwd()), *sys.path])},
        )
        assert process.stdout is not None
        for line in process.stdout:
            if line.split() == ["move", str(last)]:
                break
        else:
            raise AssertionError("it ended before it was killed")
        time.sleep(generator.uniform(0.0, 0.15))
        process.kill()
        process.communicate()
        noted = [record.has_image for record in read_views(folder)]
        assert sum(noted) in (last, last + 1)
        _, n_captures = continue_scan(folder, world)
        assert n_captures == VIEWS - sum(noted)
        assert contents(folder) == undisturbed


@pytest.fixture
def small_disk(tmp_path: Path, undisturbed: dict[str, bytes]) -> Iterator[tuple[Path, Callable[[], None]]]:
    """A file system that two and a half views fill, and what makes it larger."""
    if os.geteuid() != 0:
        pytest.skip("mounting a small disk needs root")
    view = sum(len(undisturbed[f"rgbd/frame-000000.{end}"]) for end in ("color.png", "depth.png"))
    folder = tmp_path / "disk"
    folder.mkdir()
    size = f"size={int(2.5 * view) // 1024}k"
    if subprocess.run(["mount", "-t", "tmpfs", "-o", size, "tmpfs", folder], check=False).returncode:
        pytest.skip("no small disk can be mounted here")
    yield folder, lambda: subprocess.run(["mount", "-o", "remount,size=50m", folder], check=True)  # type: ignore[misc]
    subprocess.run(["umount", "-l", folder], check=True)


def test_a_full_disk_keeps_what_was_taken(small_disk, world: World, undisturbed: dict[str, bytes]) -> None:
    disk, enlarge = small_disk
    folder = disk / "scan"
    for _ in range(2):
        with pytest.raises(SessionError, match=r"The disk that holds .*scan is full: free some space"):
            scan_into(folder, world)
        states = [record.state for record in read_views(folder)]
        assert states == [ViewState.TAKEN] * 2 + [ViewState.PENDING] * 2
    enlarge()
    _, n_captures = continue_scan(folder, world)
    assert n_captures == 2
    assert contents(folder) == undisturbed


def test_a_disk_that_is_full_at_one_view(
    monkeypatch: pytest.MonkeyPatch, world: World, tmp_path: Path, undisturbed: dict[str, bytes]
) -> None:
    write_frame = store.write_frame

    def full(frame: RgbdFrame, folder: Path) -> None:
        if frame.name == "frame-000003":
            raise OSError(errno.ENOSPC, "No space left on device")
        write_frame(frame, folder)

    with monkeypatch.context() as patch:
        patch.setattr(store, "write_frame", full)
        with pytest.raises(SessionError, match="is full"):
            scan_into(tmp_path, world)
    _, n_captures = continue_scan(tmp_path, world)
    assert n_captures == 1
    assert contents(tmp_path) == undisturbed


def test_publishing_copies_everything(world: World, tmp_path: Path, undisturbed: dict[str, bytes]) -> None:
    store = ScanStore(tmp_path / "scan", ORIGIN)
    scan_into(store.folder, world)
    (tmp_path / "stage").mkdir()
    store.publish(tmp_path / "stage")
    assert contents(tmp_path / "stage") == undisturbed
    shutil.rmtree(tmp_path / "stage")
    assert contents(store.folder) == undisturbed
