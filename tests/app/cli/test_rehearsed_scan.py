"""`poursight scan` with the real driver over TCP, before a simulated camera: nothing real moves unasked."""

from __future__ import annotations

import csv
import json
import re
import threading
import time
from dataclasses import replace

import numpy as np
import pytest

from core.motion.arm_models import UR5
from core.motion.kinematics import flange_pose
from core.progress import Reporter
from core.scan import read_scan
from hardware.cell import read_cell
from hardware.scanning.store import read_views
from hardware.simulation.ur_controller.process import ControllerProcess
from tests.app.cli.test_scan_command import COARSE, few_views
from tests.patience import wait_until

pytestmark = [pytest.mark.system, pytest.mark.punctual]

pytest.importorskip("rtde_control")

HOME = read_cell().robot.home_rad
SPEED_UP = 6.0
PLACE = ("tool_x_m", "tool_y_m", "tool_z_m")
ROWS = 8
LIMIT_M_S = 0.25
HURRIED = 1.15
"""A servo whose clock is hurried catches up with targets that come late."""


@pytest.fixture
def controller():
    with ControllerProcess(joints_rad=HOME, speed_up=SPEED_UP) as controller:
        yield controller


@pytest.fixture
def words(controller, tmp_path):
    """The command line of a scan with few views, and no first look; the same for each try."""
    return command_line(controller, tmp_path, "fixed")


def command_line(controller, tmp_path, views):
    text = few_views(tmp_path, 4).read_text().replace('views = "planned"', f'views = "{views}"')
    text = text.replace('kind = "simulated"\nmodel', f'kind = "ur5"\naddress = "{controller.address}"\nmodel')
    cell = tmp_path / "rehearsal.toml"
    cell.write_text("is_rehearsal = true\n" + text)
    return ["scan", "--session", tmp_path / "session", "--cell", cell, "--object", "bowl", COARSE]


def state(controller):
    return json.loads(controller.command("state"))


def fastest_m_s(folder):
    """Of the tool, over a third of a second each: the servo of a hurried clock goes on in bursts."""
    with (folder / "states.csv").open() as file:
        rows = [[float(row[name]) for name in ("time_s", *PLACE)] for row in csv.DictReader(file)]
    change = np.array(rows)[ROWS:] - np.array(rows)[:-ROWS]
    return float((np.linalg.norm(change[:, 1:], axis=1) / change[:, 0]).max())


def test_nothing_moves_without_a_confirmation(refused, words, controller, monkeypatch):
    assert "Nothing moves without a confirmation" in refused(*words)
    monkeypatch.setattr("sys.stdin.isatty", lambda: True, raising=False)
    monkeypatch.setattr("rich.console.Console.input", lambda *a, **k: "no")
    assert "nothing moved" in refused(*words)
    assert state(controller)["joints_rad"] == pytest.approx(HOME, abs=1e-9)


def test_the_cameras_poses_are_by_the_arms_own_kinematics(poursight, words, controller, tmp_path):
    controller.command("calibration 4.5")
    code, _, err = poursight(*words, "--yes")
    assert code == 0, err
    assert "1 to 3 mm" not in err
    longer = replace(UR5, a_m=(0.0, UR5.a_m[1], UR5.a_m[2] - 0.0045, 0.0, 0.0, 0.0))
    folder = tmp_path / "session/scan"
    joints_rad = [record.view.joints_rad for record in read_views(folder)]
    taken = np.array([frame.T_base_camera for frame in read_scan(folder, Reporter()).frames])
    np.testing.assert_allclose(taken, flange_pose(longer, joints_rad) @ read_cell().camera.pose, atol=1e-3)
    published = flange_pose(UR5, joints_rad) @ read_cell().camera.pose
    apart_m = np.linalg.norm((taken - published)[:, :3, 3], axis=1)
    assert apart_m == pytest.approx(0.0045, abs=5e-4)


def test_the_route_is_shown_and_driven_slowly_and_logged(poursight, words, controller, tmp_path):
    code, out, err = poursight(*words, "--yes")
    assert code == 0, err
    route = re.search(r"4 views in about \d+ s, no part of the arm faster than (\d\.\d+) m/s", out)
    assert route, out
    assert float(route[1]) <= LIMIT_M_S
    assert 0.1 < fastest_m_s(tmp_path / "session/scans/0001") <= LIMIT_M_S * HURRIED
    events = [json.loads(line) for line in (tmp_path / "session/scans/0001/events.jsonl").open()]
    kinds = [event["kind"] for event in events]
    assert kinds == ["planned", "confirmed", "move", "move", "move", "move", "done"]
    assert "scan:" not in poursight(*words)[2], "it is not taken again, so nobody is asked"


def test_the_first_look_is_confirmed_by_itself(poursight, controller, tmp_path):
    code, out, err = poursight(*command_line(controller, tmp_path, "planned"), "--yes")
    assert code == 0, err
    assert re.search(r"A first look, for the object's box: 3 views .*\n.*: 4 views", out), out
    events = [json.loads(line) for line in (tmp_path / "session/scans/0001/events.jsonl").open()]
    kinds = [event["kind"] for event in events]
    assert kinds == ["planned", "confirmed", *3 * ["move"], "planned", "confirmed", *4 * ["move"], "done"]


def test_a_stopped_scan_goes_on_after_recovery_along_a_new_route(
    poursight, words, controller, tmp_path, monkeypatch
):
    questions = []
    controller.command("when moving in 0.3 protective stop")
    monkeypatch.setattr("sys.stdin.isatty", lambda: True, raising=False)
    monkeypatch.setattr("rich.console.Console.input", lambda _self, q, **_: questions.append(q) or "yes")
    code, _, err = poursight(*words)
    assert code == 0, err
    assert "protective stop" in err
    assert [question.split()[0] for question in questions] == ["Let", "Find", "Let"]
    events = [json.loads(line) for line in (tmp_path / "session/scans/0001/events.jsonl").open()]
    kinds = [event["kind"] for event in events if event["kind"] != "move"]
    assert kinds == ["planned", "confirmed", "stopped", "recovered", "planned", "confirmed", "done"]


def test_without_an_operator_a_stop_ends_the_scan_and_nothing_goes_on(refused, words, controller):
    stop = threading.Thread(target=_stop_when_moving, args=(controller,), daemon=True)
    stop.start()
    sentence = refused(*words, "--yes")
    assert "was stopped or paused" in sentence
    before = state(controller)["joints_rad"]
    time.sleep(0.3)
    assert state(controller)["joints_rad"] == before


def _stop_when_moving(controller):
    wait_until(lambda: np.abs(state(controller)["speeds_rad_s"]).max() > 0.1)
    controller.command("program stop")
