"""A cell's devices: built as its file says, connected and let go together."""

from __future__ import annotations

import json

import numpy as np
import pytest
from pydantic import ValidationError

from core.errors import InputError
from core.motion.kinematics import flange_pose
from core.scan.model import RgbdFrame
from hardware.cell import SIMULATED_CELL, Cell, CellSettings, open_cell, read_cell
from hardware.cell.settings import ARMS
from hardware.errors import CameraLost
from hardware.grippers.simulated import SimulatedGripper
from hardware.interfaces import CameraImage
from hardware.robots.ur.robot import UR5Robot
from hardware.simulation.objects import builtin_object
from hardware.simulation.placing import world_with
from hardware.simulation.world import World

SETTINGS = read_cell()
REAL = read_cell(SIMULATED_CELL.with_name("ur5_example.toml"))


@pytest.fixture(scope="module")
def world() -> World:
    return world_with(builtin_object("mug"), SETTINGS.place, 0)


class Device:
    """Writes down when it is entered and left; one may be missing."""

    def __init__(self, name: str, log: list[str], is_missing: bool = False) -> None:
        self.name = name
        self._log = log
        self._is_missing = is_missing

    def __enter__(self) -> Device:
        if self._is_missing:
            raise CameraLost(f"There is no {self.name}; plug it in.")
        self._log.append(f"+{self.name}")
        return self

    def __exit__(self, *error: object) -> None:
        self._log.append(f"-{self.name}")

    def capture(self) -> CameraImage:
        raise CameraLost("Nothing to see; plug it in.")


def test_the_arm_starts_at_home_and_is_the_cells(world: World) -> None:
    with open_cell(SETTINGS, world) as cell:
        np.testing.assert_array_equal(cell.robot.state().joints_rad, SETTINGS.robot.home_rad)
        assert cell.robot.name == "simulated UR5"
        assert not cell.gripper.is_closed
        cell.gripper.close()
        assert cell.gripper.is_closed


def test_the_camera_hangs_at_the_flange_by_the_hand_eye_calibration(world: World) -> None:
    perfect = SETTINGS.simulation.model_copy(update={"is_perfect": True})
    settings = SETTINGS.model_copy(update={"simulation": perfect})
    with open_cell(settings, world) as cell:
        cell.robot.move_joints([settings.robot.home_rad, settings.scan.views_rad[3]], 1.0, 1.0).wait(1.0)
        state = cell.robot.state()
        expected = flange_pose(ARMS["UR5"], settings.scan.views_rad[3])
        np.testing.assert_allclose(state.T_base_flange, expected, atol=1e-12)
        T_base_camera = expected @ settings.camera.pose
        image = cell.camera.capture()
    frame = RgbdFrame("frame-000000", image.color, image.depth_m, T_base_camera)
    heights = (
        frame.points_m(image.intrinsics, max_depth_m=3.0, stride=5)[:, 2] - settings.place.table_height_m
    )
    assert heights.min() > -1e-4
    assert (heights < 1e-4).mean() > 0.2
    assert (heights > 0.06).any()


def test_a_simulated_cell_needs_an_object_and_a_real_one_refuses_it(world: World) -> None:
    with pytest.raises(InputError, match="no object was chosen"):
        open_cell(SETTINGS)
    with pytest.raises(InputError, match="not a chosen one"):
        open_cell(REAL, world)


def test_a_real_cell_has_the_real_arm_and_the_gripper_in_its_hand() -> None:
    cell = open_cell(REAL)
    assert isinstance(cell.robot, UR5Robot)
    assert cell.robot.name == "UR5 at 192.168.0.10"
    assert cell.gripper.name == "gripper at tool output 0"
    without = REAL.gripper.model_copy(update={"kind": "simulated"})
    assert isinstance(open_cell(REAL.model_copy(update={"gripper": without})).gripper, SimulatedGripper)


def test_a_rehearsal_drives_the_real_arm_in_front_of_a_simulated_camera(world: World) -> None:
    table = json.loads(REAL.model_dump_json()) | {"camera": json.loads(SETTINGS.camera.model_dump_json())}
    with pytest.raises(ValidationError, match="is_rehearsal"):
        CellSettings.model_validate(table)
    rehearsal = CellSettings.model_validate(table | {"is_rehearsal": True})
    assert not rehearsal.is_simulated, "an arm moves"
    cell = open_cell(rehearsal, world)
    assert isinstance(cell.robot, UR5Robot)
    assert cell.camera.name == "simulated camera"
    with pytest.raises(ValidationError, match="a rehearsal has a simulated camera"):
        CellSettings.model_validate(json.loads(REAL.model_dump_json()) | {"is_rehearsal": True})


def test_what_is_no_rehearsal_is_recorded_as_before() -> None:
    assert "is_rehearsal" not in SETTINGS.model_dump_json()


def cell_of(world: World, log: list[str], is_camera_missing: bool) -> Cell:
    cell = open_cell(SETTINGS, world)
    camera = Device("camera", log, is_camera_missing)
    return Cell(SETTINGS, camera, cell.robot, Device("gripper", log), cell.scene)  # type: ignore[arg-type]


def test_devices_are_let_go_in_reverse_and_may_be_entered_again(world: World) -> None:
    log: list[str] = []
    cell = cell_of(world, log, is_camera_missing=False)
    for _ in range(2):
        with cell:
            assert log == ["+gripper", "+camera"]
        assert log == ["+gripper", "+camera", "-camera", "-gripper"]
        log.clear()


def test_a_missing_camera_lets_the_others_go(world: World) -> None:
    log: list[str] = []
    with pytest.raises(CameraLost, match="no camera"), cell_of(world, log, is_camera_missing=True):
        pass
    assert log == ["+gripper", "-gripper"]
