"""`poursight plan`, `pour` and `outcome` from the command line."""

import json
import shutil
import socket
import threading
import time

import pytest

from core.resources import RESOURCES
from core.session.cups import next_cup
from core.session.pour_runs import PourRun
from hardware.cell import read_cell
from hardware.simulation.ur_controller.process import ControllerProcess
from tests.app.cli.at_a_terminal import TerminalSession
from tests.app.cli.commanding import command
from tests.app.cli.test_scan_command import QUICK, SIMULATED
from tests.app.sessions import copied, made_once
from tests.patience import HANG_S, wait_until

pytestmark = [pytest.mark.system, pytest.mark.punctual]

pytest.importorskip("rtde_control")

SHELF_OVER_THE_CUP = """[[obstacles]]
name = "shelf"
min_m = [-0.6, 0.0, 0.02]
max_m = [-0.4, 0.2, 0.5]
#"""


@pytest.fixture(scope="module")
def imagined(tmp_path_factory):
    """A bowl, scanned and imagined."""

    def imagine(session):
        command("scan", "--session", session, "--object", "bowl", *QUICK)
        command("imagine", session)

    return made_once(tmp_path_factory, "imagined_bowl", imagine)


@pytest.fixture(scope="module")
def planned(imagined, tmp_path_factory):
    """The same with pours from one direction only, the arm's motions for them judged."""

    def plan(session):
        command("imagine", copied(imagined, session), "--set=pouring.theta_fixed_rad=-0.8")
        command("plan", session)

    return made_once(tmp_path_factory, "planned_bowl", plan)


@pytest.fixture
def session(imagined, tmp_path):
    return copied(imagined, tmp_path / "session")


@pytest.fixture
def planned_session(planned, tmp_path):
    return copied(planned, tmp_path / "session")


def real_cell(tmp_path, address, *changes):
    """The simulated cell's places with a real robot at an address."""
    text = SIMULATED.read_text()
    text = text.replace('kind = "simulated"', 'kind = "realsense"', 1)
    text = text.replace('kind = "simulated"', f'kind = "ur5"\naddress = "{address}"', 1)
    for old, new in changes:
        assert old in text
        text = text.replace(old, new, 1)
    path = tmp_path / "cell.toml"
    path.write_text(text)
    return path


ANSWERS = {
    "Let the program": "y",
    "Is the cup in the hand": "y",
    "Back off along": "y",
    "Let the UR5": "y",
    "How many candies were spilled": "0",
    "Remarks?": "",
}
"""By words of the questions."""
MOST_BEGINNINGS = 3
LOST = "The control program on the robot was stopped or paused"


def poured(poursight, session):
    """Pour; begun again where the simulated robot's program was lost: the whole machine stood still."""
    for _ in range(MOST_BEGINNINGS):
        code, out, err = poursight("pour", session, "--yes")
        if LOST not in err:
            break
        shutil.rmtree(session / "pours")
    return code, out, err


def test_a_pour_that_is_likely_to_spill_has_to_be_asked_for(poursight, planned_session):
    certain = "--set=risk.wanted_clean=0.99"
    code, out, err = poursight("imagine", planned_session, certain, "--json", "-")
    assert code == 0, err
    assert "at least 99 % is wanted" in json.loads(out)["advice"]
    code, out, err = poursight("pour", planned_session, "--yes")
    assert code == 1
    assert "Pouring is not advised" in err and "--anyway" in err
    assert not (planned_session / "pours").exists(), "nothing moved"
    code, out, err = poursight("pour", planned_session, "--yes", "--anyway")
    assert code == 0, err
    assert "Pouring is not advised" in out
    assert len(list((planned_session / "pours").iterdir())) == 1
    assert poursight("report", planned_session)[0] == 0
    assert "Pouring is not advised" in (planned_session / "report.html").read_text()


def test_a_plan_then_a_pour_then_the_report(poursight, session):
    code, out, err = poursight("plan", session)
    assert code == 0, err
    assert "The arm can make" in out
    assert "rotate back" in out
    assert "mm around the cup" in out
    assert "motion:" in err
    code, again, err = poursight("plan", session)
    assert (code, again) == (0, out)
    assert "motion:" not in err, "the judgement was kept"

    code, out, err = poured(poursight, session)
    assert code == 0, err
    assert "of 20 candies were spilled (simulated" in out
    run = session / "pours" / "0001"
    events = [json.loads(line) for line in (run / "events.jsonl").read_text().splitlines()]
    kinds = [event["kind"] for event in events]
    assert kinds[0] == "confirmed"
    assert kinds[-2:] == ["done", "measured"]
    assert events[-1]["pivot_error_m"] < 0.0005
    outcome = json.loads((run / "outcome.json").read_text())
    assert outcome["n_spilled"] <= 2
    sent = json.loads((run / "controller.json").read_text())
    assert any(entry["what"] == "command" for entry in sent)

    assert poursight("outcome", session, "--spilled", 3, "--remarks", "seen by me")[0] == 0
    code, out, _ = poursight("report", session)
    assert code == 0
    page = (session / "report.html").read_text()
    assert "Executed pours" in page
    assert "3 of 20 candies were spilled. seen by me" in page


def test_nothing_moves_without_a_confirmation(refused, planned_session, monkeypatch):
    session = planned_session
    assert "Nothing moves without a confirmation" in refused("pour", session)
    monkeypatch.setattr("sys.stdin.isatty", lambda: True, raising=False)
    monkeypatch.setattr("rich.console.Console.input", lambda *a, **k: "no")
    assert "nothing moved" in refused("pour", session)
    assert not (session / "pours").exists()


def test_more_than_fits_is_refused_before_anything_moves(poursight, refused, session):
    too_many = (
        "--set=containability.verdict=capacity",
        "--set=capacity.n_fillings=1",
        "--set=capacity.n_aimed=20",
        "--set=capacity.lattice_points=50000",
        "--set=holding.n_load=6",
        "--set=holding.tilt_step_rad=0.2",
        "--set=pouring.n_pour=900",
        "--set=pouring.amount=number",
        "--set=pouring.theta_fixed_rad=0",
        "--set=pouring.settle_s=0.1",
        "--set=pouring.turn_s=0.3",
        "--set=risk.n_tries=0",
    )
    code, out, _ = poursight("imagine", session, *too_many)
    assert code == 0
    assert "900 candies are more than 1.3 times the" in out
    assert "Nothing is poured. 900 candies are more than 1.3 times the" in refused("pour", session, "--yes")
    assert not (session / "pours").exists()


def test_several_cups_are_poured_one_after_the_other(poursight, refused, session, tmp_path):
    two_cups = (
        "--set=containability.verdict=capacity",
        "--set=capacity.n_fillings=1",
        "--set=capacity.n_aimed=20",
        "--set=capacity.lattice_points=50000",
        "--set=holding.n_load=6",
        "--set=holding.tilt_step_rad=0.2",
        "--set=pouring.cup.length_m=0.05",
        "--set=pouring.n_pour=40",
        "--set=risk.n_tries=0",
    )
    code, out, err = poursight("imagine", session, *two_cups)
    assert code == 0, err
    assert "Pour 2 cups of 20 and 20 candies" in out
    cell = real_cell(tmp_path, "127.0.0.1")
    assert "nobody would fill them" in refused("pour", session, "--yes", "--cell", cell)

    code, out, err = poursight("pour", session, "--yes")
    assert code == 0, err
    first, second = (
        json.loads((session / "pours" / name / "outcome.json").read_text()) for name in ("0001", "0002")
    )
    assert first["n_candies"] == second["n_candies"] == 20
    assert (first["facts"]["n_before"], second["facts"]["n_before"]) == (0, first["facts"]["n_in_object"])
    assert second["facts"]["n_in_object"] > first["facts"]["n_in_object"]

    shutil.rmtree(session / "pours" / "0002")
    digest = PourRun.load(session / "pours" / "0001").imagination
    assert next_cup(session, digest, (20, 20)).number == 2
    assert "Nothing moves without a confirmation" in refused("pour", session, "--emptied")
    assert next_cup(session, digest, (20, 20)).number == 1


def test_no_outcome_before_a_pour(refused, session):
    assert "No pour was made" in refused("outcome", session, "--spilled", 1)


def test_a_mesh_is_in_no_cell(refused, mesh_session):
    assert "holds a mesh" in refused("plan", mesh_session)


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("cup_station_m = [-0.50, 0.10, 0.015]", "cup_station_m = [1.60, 0.10, 0.015]", "at its station"),
        ("# [[obstacles]]", SHELF_OVER_THE_CUP, "shelf"),
        ("[scan]", "[motion]\ncup_clearance_m = 0.05\n\n[scan]", "cup_clearance_m must not exceed"),
    ],
)
def test_a_cell_in_which_nothing_can_be_poured(refused, session, tmp_path, old, new, said):
    text = SIMULATED.read_text()
    assert old in text
    cell = tmp_path / "cell.toml"
    cell.write_text(text.replace(old, new, 1))
    assert said in refused("pour", session, "--cell", cell, "--yes")
    assert not (session / "motion").exists(), "no pour was judged first"
    assert not (session / "pours").exists()


def test_an_address_where_nobody_listens(refused, planned_session, tmp_path):
    cell = real_cell(tmp_path, "127.9.9.9")
    assert "127.9.9.9" in refused("pour", planned_session, "--cell", cell, "--yes")
    assert not (planned_session / "pours").exists()


def test_an_address_where_somebody_else_listens(refused, planned_session, tmp_path):
    with socket.create_server(("127.9.9.8", 29999)) as stranger:
        threading.Thread(target=greet, args=(stranger,), daemon=True).start()
        sentence = refused("pour", planned_session, "--cell", real_cell(tmp_path, "127.9.9.8"), "--yes")
    assert "no UR controller" in sentence
    assert not (planned_session / "pours").exists()


def greet(server):
    connection, _ = server.accept()
    connection.sendall(b"220 mail.example ESMTP\r\n")
    time.sleep(5)


def test_another_arm_than_the_cell_file_says(refused, planned_session, tmp_path):
    with ControllerProcess("UR5e", "5.11", joints_rad=[4.57, -1.5, -0.6, -2.25, 1.5, 0.7]) as controller:
        cell = real_cell(tmp_path, controller.address)
        sentence = refused("pour", planned_session, "--cell", cell, "--yes")
        state = json.loads(controller.command("state"))
    assert "not the UR5 of the cell file" in sentence
    assert state["joints_rad"] == pytest.approx([4.57, -1.5, -0.6, -2.25, 1.5, 0.7])
    assert not (planned_session / "pours").exists()


def test_the_example_of_a_real_cell_names_its_station():
    assert "cup_station_m = [-0.50, 0.10, 0.015]" in (RESOURCES / "cells" / "ur5_example.toml").read_text()


def test_a_killed_programs_cup_is_brought_home_by_the_next_one_which_pours(planned_session, tmp_path):
    session = planned_session
    home_rad = read_cell(SIMULATED).robot.home_rad
    with ControllerProcess("UR5", "3.15", joints_rad=home_rad, speed_up=3.0) as controller:
        cell = real_cell(tmp_path, controller.address, ('kind = "simulated"', 'kind = "ur5"'))
        command("plan", session, "--cell", cell)
        events = session / "pours" / "0001" / "events.jsonl"
        killed = TerminalSession("pour", session, "--cell", cell, "--anyway")
        thread = threading.Thread(target=killed.answer, args=(ANSWERS, HANG_S), daemon=True)
        thread.start()
        wait_until(lambda: killed.has_ended or (events.is_file() and '"carry"' in events.read_text()))
        assert not killed.has_ended, killed.transcript
        killed.process.kill()
        thread.join(HANG_S)

        again = TerminalSession("pour", session, "--cell", cell, "--anyway")
        assert again.answer(ANSWERS, HANG_S) == 0, again.transcript
        joints_rad = json.loads(controller.command("state"))["joints_rad"]
    assert "The gripper is closed. The arm is on the path of run 0001" in again.transcript
    assert "Back off along the checked path" in again.transcript
    assert "The arm is home. Make sure that the cup is at its station and filled." in again.transcript
    runs = [PourRun.load(session / "pours" / f"{number:04d}") for number in (1, 2, 3)]
    assert [run.is_done for run in runs] == [False, True, True]
    assert runs[2].outcome is not None and runs[2].outcome.n_spilled == 0
    assert joints_rad == pytest.approx(home_rad, abs=0.002)
