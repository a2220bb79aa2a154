"""Cell files: the shipped ones are read, and every fault is one sentence that names file and field."""

from __future__ import annotations

from pathlib import Path

import pytest

from core.errors import InputError
from hardware.cell import SIMULATED_CELL, read_cell

UR5_EXAMPLE = SIMULATED_CELL.with_name("ur5_example.toml")
SHIPPED = SIMULATED_CELL.read_text(encoding="utf-8")


def test_the_simulated_cell_is_read() -> None:
    cell = read_cell()
    assert cell.is_simulated
    assert cell.robot.kind == "simulated"
    assert cell.place.platform_height_m == 0.08
    assert cell.place.platform_center_m == pytest.approx([-0.06, -0.35, 0.08])
    assert cell.simulation.noise.pose_position_m == 0.001
    assert not cell.simulation.is_perfect


def test_the_example_for_a_real_cell_is_read() -> None:
    cell = read_cell(UR5_EXAMPLE)
    assert not cell.is_simulated
    assert cell.robot.kind == "ur5"
    assert cell.robot.address
    assert cell.camera.kind == "realsense"
    assert cell.gripper.kind == "ur5"


def test_paths_count_from_the_files_folder(tmp_path: Path) -> None:
    text = SHIPPED.replace('kind = "simulated"', 'kind = "replay"\nrecording = "old/scan"', 1)
    text = text.replace('[robot]\nkind = "simulated"', '[robot]\nkind = "replay"')
    path = tmp_path / "cell.toml"
    path.write_text(text, encoding="utf-8")
    assert read_cell(path).camera.recording == tmp_path / "old" / "scan"


FAULTS = {
    "a missing field": ("table_height_m = 0.015\n", "", "lacks 'place.table_height_m'"),
    "a missing section": ("[robot]", "[gripper2]", "lacks 'robot'"),
    "no views": ("views_rad = [", "views_rad = []\nothers = [", "scan.views_rad"),
    "an unknown field": ("settle_s = 0.3", "setle_s = 0.3", "'scan.setle_s'"),
    "an unknown section": ("[gripper]", "[griper]", "'griper'"),
    "a scaled rotation": ("[1.0, 0.0, 0.0, 0.0]", "[1.1, 0.0, 0.0, 0.0]", "T_flange_camera"),
    "a mirrored rotation": ("[1.0, 0.0, 0.0, 0.0]", "[-1.0, 0.0, 0.0, 0.0]", "T_flange_camera"),
    "a wrong last row": ("[0.0, 0.0, 0.0, 1.0]", "[0.0, 0.0, 0.0, 0.5]", "T_flange_camera"),
    "a short row": ("[1.0, 0.0, 0.0, 0.0]", "[1.0, 0.0, 0.0]", "T_flange_camera"),
    "the kinematics of another arm": (
        "[robot]\n",
        "[robot]\nown_kinematics = {theta_rad = [0, 0, 0, 0, 0, 0], a_m = [0, -0.6, -0.5, 0, 0, 0], "
        "d_m = [0.1, 0, 0, 0.1, 0.1, 0.1], alpha_rad = [1.57, 0, 0, 1.57, -1.57, 0]}\n",
        "own_kinematics is of no UR5",
    ),
    "a crop box without volume": ("0.18, -0.15, 0.35]", "0.18, -0.55, 0.35]", "crop_max_m"),
    "a crop box above the platform": ("-0.55, 0.03]", "-0.55, 0.09]", "platform_height_m"),
    "a platform without area": ("platform_max_m = [0.14", "platform_max_m = [-0.26", "platform_max_m"),
    "a platform below the table": (
        "platform_height_m = 0.08",
        "platform_height_m = 0.01",
        "platform_height_m",
    ),
    "an obstacle without volume": (
        "[scan]",
        '[[obstacles]]\nname = "monitor"\nmin_m = [0.5, 0.4, 0.0]\nmax_m = [0.8, 0.4, 0.5]\n[scan]',
        "max_m of monitor",
    ),
    "replay without a recording": ('kind = "simulated"', 'kind = "replay"', "recording"),
    "replay with an arm": (
        'kind = "simulated"',
        'kind = "replay"\nrecording = "old"',
        "camera and robot must both be of kind 'replay'",
    ),
    "openni without intrinsics": ('kind = "simulated"', 'kind = "openni"', "intrinsics"),
    "an unknown camera": ('kind = "simulated"', 'kind = "kinect"', "camera.kind"),
    "a ur5 without address": ('[robot]\nkind = "simulated"', '[robot]\nkind = "ur5"', "address"),
    "a simulated camera on a real arm": (
        '[robot]\nkind = "simulated"',
        '[robot]\nkind = "ur5"\naddress = "10.0.0.2"',
        "robot.kind",
    ),
    "an unknown arm": ('model = "UR5"', 'model = "UR9"', "robot.model"),
    "not a number": ("table_height_m = 0.015", "table_height_m = nan", "place.table_height_m"),
    "nan in a view": ("[3.8755,", "[nan,", "scan.views_rad.0.0"),
    "a view beyond a whole turn": ("[3.8755,", "[38.755,", "scan.views_rad.0.0"),
    "a view of five joints": ("[3.8755,", "[", "scan.views_rad.0"),
    "a word for a number": ("table_height_m = 0.015", 'table_height_m = "low"', "place.table_height_m"),
    "a camera without thickness": ("0.18, 0.036, 0.025", "0.18, 0.036, -0.025", "camera.size_m"),
    "no speed": ("joint_speed_rad_s = 0.8", "joint_speed_rad_s = 0", "robot.joint_speed_rad_s"),
    "a robotiq gripper without model": (
        '[gripper]\nkind = "simulated"',
        '[gripper]\nkind = "robotiq"',
        "needs 'model'",
    ),
    "a robotiq gripper that opens wider than it can": (
        '[gripper]\nkind = "simulated"',
        '[gripper]\nkind = "robotiq"\nmodel = "Hand-E"\nopen_width_m = 0.06',
        "opens to 0.05 m and no wider",
    ),
    "a robotiq gripper that closes no further": (
        '[gripper]\nkind = "simulated"',
        '[gripper]\nkind = "robotiq"\nmodel = "2F-85"\nopen_width_m = 0.05\nclosed_width_m = 0.05',
        "closed_width_m must be less",
    ),
    "an unknown robotiq gripper": (
        '[gripper]\nkind = "simulated"',
        '[gripper]\nkind = "robotiq"\nmodel = "3F"',
        "gripper.model",
    ),
    "a model of another gripper": ("[gripper]", '[gripper]\nmodel = "2F-85"', "said of a robotiq gripper"),
    "no tries": ("tries = 3", "tries = 0", "scan.tries"),
}


@pytest.mark.parametrize(("old", "new", "named"), FAULTS.values(), ids=FAULTS)
def test_a_fault_is_one_sentence_with_file_and_field(old: str, new: str, named: str, tmp_path: Path) -> None:
    assert old in SHIPPED
    path = tmp_path / "cell.toml"
    path.write_text(SHIPPED.replace(old, new, 1), encoding="utf-8")
    with pytest.raises(InputError) as refused:
        read_cell(path)
    said = str(refused.value)
    assert str(path) in said
    assert named in said
    assert "\n" not in said
    assert said.endswith(".")


def test_no_toml_and_no_file(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"nowhere\.toml cannot be read"):
        read_cell(tmp_path / "nowhere.toml")
    with pytest.raises(InputError, match="cannot be read"):
        read_cell(tmp_path)
    path = tmp_path / "cell.toml"
    path.write_text("name = ", encoding="utf-8")
    with pytest.raises(InputError, match=r"cell\.toml is not valid TOML \(.+\); correct it"):
        read_cell(path)
    path.write_bytes(b"name = '\xff'")
    with pytest.raises(InputError, match=r"cell\.toml cannot be read"):
        read_cell(path)
