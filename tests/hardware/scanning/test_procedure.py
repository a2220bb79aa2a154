"""The scan when nothing is broken: what it takes, keeps, tells, and how it is held up."""

from __future__ import annotations

import os
import signal
import time
from collections.abc import Iterator
from pathlib import Path
from threading import Thread, Timer

import numpy as np
import pytest

from core.errors import Cancelled, StageError
from core.motion.arm_models import UR5
from core.motion.kinematics import flange_pose
from core.progress import Reporter
from core.scan import read_scan
from core.scan.model import RgbdFrame
from hardware.cell import Cell, open_cell
from hardware.errors import RobotStopped
from hardware.scanning.control import ScanControl
from hardware.scanning.procedure import ScanProcedure
from hardware.scanning.store import ScanStore, read_views
from hardware.scanning.views import ViewRecord, ViewState
from hardware.simulation.world import World
from tests.awake import in_time
from tests.hardware.scanning.faulty import (
    ORIGIN,
    SEED,
    Listening,
    WatchedRobot,
    contents,
    planned,
    scan_into,
    small_cell,
)
from tests.patience import wait_until

VIEWS = 4


def test_every_view_is_on_disk_before_the_next_move(world: World, tmp_path: Path) -> None:
    seen = []

    def look(move: int) -> None:
        files = {path.name for path in (tmp_path / "rgbd").glob("*")}
        expected = {
            f"frame-{k:06d}.{end}" for k in range(move) for end in ("color.png", "depth.png", "pose.txt")
        }
        assert files == expected
        noted = read_views(tmp_path)
        assert [record.has_image for record in noted] == [k < move for k in range(len(noted))]
        seen.append(move)

    def watch(cell: Cell) -> None:
        cell.robot = WatchedRobot(cell.robot, before=look)

    scan_into(tmp_path, world, watch)
    assert seen == list(range(VIEWS))


def test_poses_are_those_of_the_joints_and_the_hand_eye_calibration(world: World) -> None:
    procedure = scan_into(None, world)
    settings = small_cell()
    for frame, joints in zip(procedure.scan().frames, settings.scan.views_rad, strict=True):
        np.testing.assert_allclose(frame.T_base_camera, flange_pose(UR5, joints) @ settings.camera.pose)


def test_the_folder_is_a_scan_that_can_be_read(world: World, tmp_path: Path) -> None:
    taken = scan_into(tmp_path / "scan", world).scan()
    scan = read_scan(tmp_path / "scan", Reporter())
    assert scan.platform_height_m == taken.platform_height_m == 0.08
    assert scan.crop_box == taken.crop_box == small_cell().place.crop_box
    assert scan.intrinsics == taken.intrinsics
    for read, frame in zip(scan.frames, taken.frames, strict=True):
        assert read.name == frame.name
        np.testing.assert_array_equal(read.color, frame.color)
        np.testing.assert_allclose(read.depth_m, frame.depth_m, atol=5.1e-4)
        np.testing.assert_array_equal(read.T_base_camera, frame.T_base_camera)


def test_after_each_view_the_growing_mesh_is_offered(world: World) -> None:
    faces, states = [], []

    def taken(record: ViewRecord, frame: RgbdFrame, volume) -> None:
        assert record.view.name == frame.name
        states.append(record.state)
        faces.append(len(volume.mesh().faces))

    reporter = Listening()
    scan_into(None, world, reporter=reporter, taken=taken)
    assert states == [ViewState.TAKEN] * VIEWS
    assert faces[0] > 500
    assert faces[-1] > 1.3 * faces[0]
    assert reporter.done == [1, 2, 3, 4]
    assert reporter.warnings == []


def test_one_seed_one_scan(world: World, tmp_path: Path, undisturbed: dict[str, bytes]) -> None:
    scan_into(tmp_path, world)
    assert contents(tmp_path) == undisturbed


def test_a_view_that_touches_something_is_left_out_with_its_reason(world: World) -> None:
    settings = small_cell()
    views, home = settings.scan.views_rad, settings.robot.home_rad
    low = (home[0], 0.25, *home[2:])
    scan = settings.scan.model_copy(update={"views_rad": (*views[:2], low, *views[2:])})
    reporter = Listening()
    procedure = scan_into(None, world, settings=settings.model_copy(update={"scan": scan}), reporter=reporter)
    states = [record.state for record in procedure.records]
    assert states == [ViewState.TAKEN] * 2 + [ViewState.FAILED] + [ViewState.TAKEN] * 2
    assert [frame.name[-1] for frame in procedure.scan().frames] == ["0", "1", "3", "4"]
    [said] = reporter.warnings
    assert said.startswith("View frame-000002 is left out: The goal of the move")
    assert "table" in said


def test_too_few_views_are_no_scan(world: World) -> None:
    with pytest.raises(StageError, match="Only 2 views could be taken"):
        scan_into(None, world, settings=small_cell((0, 8))).scan()


def test_a_single_view_is_taken_again(world: World, tmp_path: Path) -> None:
    settings = small_cell()
    with open_cell(settings, world, SEED) as cell:
        procedure = ScanProcedure(cell, ScanStore(tmp_path, ORIGIN), Listening())
        procedure.take(planned(settings))
        before, old_mesh = contents(tmp_path), procedure.volume.mesh()
        old = procedure.scan().frames
        procedure.retake(["frame-000001"])
        new = procedure.scan().frames
        with pytest.raises(StageError, match="no view 'frame-000009'; its views are frame-000000"):
            procedure.retake(["frame-000009"])
    after = contents(tmp_path)
    changed = {name for name in after if after[name] != before[name]}
    # The same place, another shot: only the noise of the depth is new.
    assert changed == {"rgbd/frame-000001.depth.png"}
    assert [frame.name for frame in new] == [frame.name for frame in old]
    assert not np.array_equal(new[1].depth_m, old[1].depth_m)
    assert not np.array_equal(procedure.volume.mesh().vertices_m[:100], old_mesh.vertices_m[:100])
    assert [record.state for record in read_views(tmp_path)] == [ViewState.TAKEN] * VIEWS


def test_a_paused_scan_waits_and_goes_on(world: World, tmp_path: Path, undisturbed: dict[str, bytes]) -> None:
    control = ScanControl()
    names: list[str] = []

    def taken(record: ViewRecord, frame: RgbdFrame, volume) -> None:
        names.append(record.view.name)
        if len(names) == 2:
            control.pause()

    arguments = {"control": control, "taken": taken}
    scanning = Thread(target=scan_into, args=(tmp_path, world), kwargs=arguments, daemon=True)
    scanning.start()
    wait_until(lambda: control.is_paused)
    time.sleep(0.4)
    assert len(names) == 2
    assert scanning.is_alive()
    control.resume()
    scanning.join(20)
    assert not scanning.is_alive()
    assert contents(tmp_path) == undisturbed


def test_a_paused_scan_can_be_cancelled(world: World) -> None:
    control, reporter = ScanControl(), Listening()
    control.pause()
    Timer(0.2, reporter.cancel).start()
    with pytest.raises(Cancelled):
        scan_into(None, world, control=control, reporter=reporter)


@pytest.fixture
def heard_ctrl_c() -> Iterator[None]:
    """Whoever runs the tests in the background of a shell has Ctrl-C ignored."""
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    signal.signal(signal.SIGINT, before)


@pytest.mark.usefixtures("heard_ctrl_c")
@pytest.mark.parametrize("how", ["cancel", "ctrl-c"])
def test_stopped_in_mid_move_the_arm_stands_and_the_next_run_continues(
    how: str, world: World, tmp_path: Path, undisturbed: dict[str, bytes]
) -> None:
    """The first view at once, then by the clock."""
    settings = small_cell()
    with open_cell(settings, world, SEED) as cell:
        first = ScanProcedure(cell, ScanStore(tmp_path, ORIGIN), Listening())
        first.take(planned(settings)[:1])

    reporter = Listening()
    slow = small_cell(is_instant=False)
    with open_cell(slow, world, SEED) as cell:
        arm = cell.robot

        def stop(_: int) -> None:
            ask = reporter.cancel if how == "cancel" else lambda: os.kill(os.getpid(), signal.SIGINT)
            Timer(0.4, ask).start()

        cell.robot = WatchedRobot(arm, begun=stop)
        procedure = ScanProcedure(cell, ScanStore(tmp_path, ORIGIN), reporter)
        began_s = time.monotonic()
        with pytest.raises(Cancelled if how == "cancel" else KeyboardInterrupt):
            procedure.take(planned(slow))
        in_time(time.monotonic() - began_s, 2)
        # As soon as it says so, the arm stands, on its way.
        state = arm.state()
        assert not state.joint_speeds_rad_s.any()
        home, goal = slow.robot.home_rad, slow.scan.views_rad[1]
        assert np.abs(state.joints_rad - home).max() > 0.01
        assert np.abs(state.joints_rad - goal).max() > 0.01
    assert [record.state for record in read_views(tmp_path)] == [ViewState.TAKEN]
    scan_into(tmp_path, world)
    assert contents(tmp_path) == undisturbed


def test_an_arm_that_somebody_stops_ends_the_scan(world: World) -> None:
    slow = small_cell(is_instant=False)
    with open_cell(slow, world, SEED) as cell:
        arm = cell.robot
        cell.robot = WatchedRobot(arm, begun=lambda _: Timer(0.3, arm.stop).start())
        with pytest.raises(RobotStopped, match="was stopped before it arrived"):
            ScanProcedure(cell, None, Listening()).take(planned(slow))


def test_by_the_clock_the_images_are_the_same(world: World, tmp_path: Path) -> None:
    chosen = (14, 15)
    clock = small_cell(chosen, is_instant=False)
    swift = clock.robot.model_copy(update={"joint_speed_rad_s": 3.0, "joint_acceleration_rad_s2": 30.0})
    scan_into(tmp_path / "instant", world, settings=small_cell(chosen))
    scan_into(tmp_path / "clock", world, settings=clock.model_copy(update={"robot": swift}))
    assert contents(tmp_path / "clock") == contents(tmp_path / "instant")
