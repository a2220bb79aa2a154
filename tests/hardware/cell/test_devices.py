"""Each kind of device that a cell file may name has a driver; any other is refused."""

from __future__ import annotations

from typing import Any, get_args

import pytest

from core.errors import InputError
from hardware.cell import SIMULATED_CELL, CellSettings, open_arm, open_cell, read_cell
from hardware.cell.devices import real_camera, real_gripper, scan_devices, ur_robot

SIMULATED = read_cell()
REAL = read_cell(SIMULATED_CELL.with_name("ur5_example.toml"))


def with_kind(settings: CellSettings, device: str, kind: str) -> CellSettings:
    """A cell whose device is of another kind, with what the file would have to say about it, unchecked."""
    more: dict[str, Any] = {
        "camera": {"intrinsics": (525.0, 525.0, 320.0, 240.0), "recording": SIMULATED_CELL.parent},
        "gripper": {"model": "Hand-E"} if kind == "robotiq" else {},
    }
    changed = {"kind": kind, **more.get(device, {})}
    return settings.model_copy(update={device: getattr(settings, device).model_copy(update=changed)})


def kinds(device: str) -> tuple[str, ...]:
    field = CellSettings.model_fields[device].annotation
    assert field is not None
    return get_args(field.model_fields["kind"].annotation)


@pytest.mark.parametrize("kind", [kind for kind in kinds("camera") if kind != "simulated"])
def test_every_kind_of_camera_is_opened_as_itself(kind: str) -> None:
    name = {"realsense": "RealSense", "openni": "OpenNI", "replay": "replay"}[kind]
    assert name in real_camera(with_kind(REAL, "camera", kind)).name


@pytest.mark.parametrize("kind", kinds("robot"))
def test_every_kind_of_robot_takes_part_in_a_scan(kind: str) -> None:
    settings = with_kind(with_kind(REAL, "robot", kind), "camera", "replay" if kind == "replay" else "openni")
    name = {"simulated": "simulated UR5", "ur5": "UR5 at", "replay": "recorded scan"}[kind]
    assert name in scan_devices(settings, None, 0)[1].name


@pytest.mark.parametrize("kind", kinds("gripper"))
def test_every_kind_of_gripper_is_opened_as_itself(kind: str) -> None:
    name = {"simulated": "simulated", "ur5": "tool output", "robotiq": "Robotiq Hand-E at 192"}[kind]
    settings = with_kind(REAL, "gripper", kind)
    assert name in real_gripper(settings, ur_robot(settings)).name


@pytest.mark.parametrize("device", ["camera", "robot", "gripper"])
def test_an_unknown_kind_is_refused_and_the_known_ones_are_named(device: str) -> None:
    settings = with_kind(REAL, device, "holographic")
    with pytest.raises(InputError, match=f"{device} of kind 'holographic'.*choose one of .*, "):
        open_cell(settings)
    if device != "camera":
        with pytest.raises(InputError, match=f"{device} of kind 'holographic'"):
            open_arm(settings)


def test_a_cell_file_with_an_unknown_kind_is_refused_in_a_sentence(tmp_path: Any) -> None:
    text = SIMULATED_CELL.read_text(encoding="utf-8").replace('kind = "simulated"', 'kind = "holographic"', 1)
    (tmp_path / "cell.toml").write_text(text, encoding="utf-8")
    with pytest.raises(InputError, match=r"cell.toml, camera.kind is not possible .*'realsense'.*correct it"):
        read_cell(tmp_path / "cell.toml")
