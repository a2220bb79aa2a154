"""The commands that set a cell up: each one, what they refuse, and what a kill leaves."""

from __future__ import annotations

import errno
import os
import subprocess
import sys
from functools import partial

import numpy as np
import pytest

from app.operations.calibration import step_names
from app.operations.calibration.cell_file import new_cell, write_views
from app.operations.calibration.provenance import read_looks, runs
from app.operations.calibration.steps import enter_board
from core.calibration.board import BoardSpec
from core.files import write_whole
from hardware.cameras.simulated_board import SimulatedBoardCamera
from hardware.cell import read_cell
from hardware.errors import CameraLost
from hardware.simulation.board_view import BoardLook
from tests.patience import wait_until

N_VIEWS = "--views=8"


@pytest.fixture(autouse=True)
def cells(tmp_path, monkeypatch):
    monkeypatch.setenv("POURSIGHT_CELLS", str(tmp_path / "cells"))
    return tmp_path / "cells"


def measured_cell(name="bench", seed=0):
    """A cell with a board, and few scan views from which to look for it."""
    path = new_cell(name, is_simulated=True, seed=seed)
    enter_board(path, BoardSpec(), "a4", 0.030)
    write_views(path, read_cell(path).scan.views_rad[:3])
    return path


def start(*words):
    return subprocess.Popen(
        [sys.executable, "-m", "app.cli", "cell", *map(str, words)],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        env=os.environ | {"PYTHONPATH": os.pathsep.join(sys.path)},
    )


def n_looks(path):
    return len(read_looks(runs(path, step_names.HAND_EYE)[-1])[1])


def test_a_cell_is_made_and_its_steps_are_listed(poursight, cells):
    code, out, _ = poursight("cell", "new", "Bench one", "--simulated")
    assert code == 0
    assert out.splitlines() == [str(cells / "bench-one.toml"), "Next: poursight cell board bench-one"]
    code, out, _ = poursight("cell", "show", "bench-one")
    assert code == 0
    rows = [line.split()[:2] for line in out.splitlines()[1:]]
    names = ["arm", "camera", "board", "hand-eye", "check", "table", "views", "reference", "cup", "dry-run"]
    assert [name for name, _ in rows] == names
    assert {state for _, state in rows} == {"open"}
    assert poursight("cell", "show", cells / "bench-one.toml")[0] == 0


def test_devices_are_tried(poursight):
    new_cell("bench", is_simulated=True)
    code, out, _ = poursight("cell", "devices", "bench")
    assert code == 0
    assert "simulated UR5" in out and "depth in" in out
    new_cell("real", is_simulated=False, address="127.1.2.3")
    code, _, err = poursight("cell", "devices", "real")
    assert code == 1 and "127.1.2.3" in err and "Traceback" not in err


def test_a_board_is_printed_measured_and_undone(poursight, cells):
    new_cell("bench", is_simulated=True)
    code, out, _ = poursight("cell", "board", "bench", "--paper=letter")
    assert code == 0 and "--measured-mm" in out
    assert (cells / "bench.calibration" / "board-letter.pdf").read_bytes().startswith(b"%PDF")
    assert poursight("cell", "board", "bench", "--measured-mm=29.9")[0] == 0
    assert "29.9 mm" in poursight("cell", "show", "bench")[1]
    assert "is forgotten" in poursight("cell", "board", "bench", "--undo")[1]


def test_a_crop_box_is_entered_and_views_have_to_be_chosen_anew(poursight):
    path = new_cell("bench", is_simulated=True)
    place = read_cell(path).place
    low, high = 1000 * np.array(place.crop_min_m) + 5, 1000 * np.array(place.crop_max_m) - 5
    words = ("--from-mm", *low.round(1), "--to-mm", *high.round(1))
    code, out, err = poursight("cell", "crop", "bench", *words)
    assert code == 0 and "Next: poursight cell views bench" in out, err
    after = read_cell(path).place
    assert np.allclose(after.crop_min_m, low / 1000) and np.allclose(after.crop_max_m, high / 1000)
    assert after.model_copy(update={"crop_min_m": place.crop_min_m, "crop_max_m": place.crop_max_m}) == place


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (("show", "nobody"), "There is no cell file"),
        (("new", "bench"), "already"),
        (("new", "?!"), "needs a name"),
        (("calibrate", "bench"), "No calibration board is entered"),
        (("check", "bench"), "No calibration board is entered"),
        (("touch", "bench"), "No calibration board is entered"),
        (("table", "bench", "--yes"), "No calibration board is entered"),
        (("board", "bench", "--dictionary=7X7"), "dictionary"),
        (("board", "bench", "--columns=60"), "take 4 to 20 each way"),
        (("board", "bench", "--measured-mm=-3"), "enter 5 to 200 mm"),
        (("cup", "bench", "--taught"), "nobody can guide it"),
        (("cup", "bench", "--taught", "--station-mm", "0", "0", "0"), "either taught or typed"),
        (("cup", "bench", "--base-mm=90"), "wider at its base"),
        (("cup", "bench", "--station-mm", "900", "900", "15"), "cannot reach the cup"),
        (("dry-run", "bench", "--yes"), "No cup was entered"),
        (("crop", "bench", "--from-mm", "0", "0", "0", "--to-mm", "0", "5", "5"), "crop box is empty"),
        (("crop", "bench", "--from-mm", "0", "0", "0", "--to-mm", "90", "90", "90"), "is not inside"),
        (("crop", "bench", "--from-mm", "0", "0", "0", "--to-mm", "nan", "1", "1"), "crop box is empty"),
        *(
            ((command, "bench", "--undo"), f"The step '{step}' of")
            for command, step in (
                ("board", "board"),
                ("calibrate", "hand-eye"),
                ("check", "check"),
                ("table", "table"),
                ("views", "views"),
                ("reference", "reference"),
                ("cup", "cup"),
                ("dry-run", "dry-run"),
            )
        ),
    ],
)
def test_what_cannot_be_is_refused_in_one_sentence_and_nothing_is_lost(refused, words, said):
    path = new_cell("bench", is_simulated=True)
    before = path.read_bytes()
    assert said in refused("cell", *words)
    assert path.read_bytes() == before


def test_a_folder_that_cannot_be_written_is_named(refused, cells):
    new_cell("bench", is_simulated=True)
    (cells / "bench.calibration").write_text("in the way")
    for words in (("board", "bench"), ("devices", "bench"), ("views", "bench", "--n=6")):
        assert str(cells) in refused("cell", *words)


@pytest.mark.system
def test_a_board_with_other_markers_or_a_mirrored_one_is_said_to_be_so(refused, monkeypatch):
    path = measured_cell()
    before = path.read_bytes()
    other = BoardSpec(dictionary="5X5_50")
    with monkeypatch.context() as patch:
        patch.setattr("hardware.cell.calibrating.with_square", lambda *_: other)
        assert "dictionary 5X5_50" in refused("cell", "calibrate", "bench")
    with monkeypatch.context() as patch:
        mirrored = partial(BoardLook, is_mirrored=True)
        patch.setattr("hardware.cameras.simulated_board.BoardLook", mirrored)
        assert "mirrored" in refused("cell", "calibrate", "bench", "--restart")
    assert path.read_bytes() == before


@pytest.mark.system
def test_squares_of_another_size_than_entered_are_refused(refused):
    path = measured_cell()
    path.write_text(path.read_text() + "square_m = 0.027\n")
    assert "measure them again" in refused("cell", "calibrate", "bench")


@pytest.mark.system
def test_a_disk_that_fills_up_ends_it_in_one_sentence_and_what_was_taken_is_kept(refused, monkeypatch):
    path = measured_cell()
    before = path.read_bytes()

    def write(target, content):
        if target.name == "view-03.png":
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC), str(target))
        write_whole(target, content)

    monkeypatch.setattr("app.operations.calibration.provenance.write_whole", write)
    assert "is full: free some space" in refused("cell", "calibrate", "bench", N_VIEWS)
    assert n_looks(path) == 2
    assert path.read_bytes() == before


@pytest.mark.system
def test_a_camera_that_is_unplugged_ends_it_in_one_sentence_and_what_was_taken_is_used(
    refused, poursight, monkeypatch
):
    path = measured_cell(seed=9)
    before = path.read_bytes()
    capture, n_taken = SimulatedBoardCamera.capture, []

    def until_unplugged(camera):
        if len(n_taken) == 4:
            raise CameraLost("The camera does not answer any more; plug it in again.")
        n_taken.append(camera)
        return capture(camera)

    with monkeypatch.context() as patch:
        patch.setattr(SimulatedBoardCamera, "capture", until_unplugged)
        assert "plug it in again" in refused("cell", "calibrate", "bench", N_VIEWS)
    kept = n_looks(path)
    assert kept == 3, "the first image tells what the camera is"
    assert path.read_bytes() == before
    code, out, err = poursight("cell", "calibrate", "bench", N_VIEWS)
    assert code == 0, err
    assert "Calibrated from 8 views" in out
    assert n_looks(path) < kept + 8, "what was taken is used"


@pytest.mark.system
def test_kill_9_in_the_middle_keeps_every_look_and_the_same_command_goes_on(poursight):
    path = measured_cell(seed=9)
    before = path.read_bytes()
    process = start("calibrate", "bench", N_VIEWS)
    wait_until(
        lambda: (
            bool(runs(path, step_names.HAND_EYE))
            and len(list(runs(path, step_names.HAND_EYE)[-1].glob("*.png"))) >= 4
        )
    )
    process.kill()
    process.communicate()
    assert path.read_bytes() == before
    kept = n_looks(path)
    assert kept >= 3
    code, out, err = poursight("cell", "calibrate", "bench", N_VIEWS)
    assert code == 0, err
    assert "Calibrated from 8 views" in out
    assert n_looks(path) - kept < 8, "what was taken is used"
    assert path.read_bytes() != before
    code, out, _ = poursight("cell", "table", "bench", "--yes")
    assert code == 0 and "above the base" in out
    assert poursight("cell", "check", "bench", "--yes")[0] == 0
    code, out, _ = poursight("cell", "touch", "bench")
    assert code == 0 and out.startswith("The tip is 0.")
    assert "touch check: 1 corner within 0." in poursight("cell", "show", "bench")[1]
    code, out, _ = poursight("cell", "reference", "bench", "--yes")
    assert code == 0 and "looked at again when a scan begins" in out
    code, out, _ = poursight("cell", "views", "bench", "--n=8")
    assert code == 0 and out.startswith("8 views at elevations of ")
