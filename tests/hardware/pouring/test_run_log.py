"""A run is on the disk as it happens, and is read from there."""

import json
import os
from pathlib import Path

import numpy as np
import pytest

from core.session.pour_runs import Outcome, PourRun, next_run_folder, pour_runs, write_outcome
from hardware.interfaces import RobotState
from hardware.modes import RobotMode, SafetyMode
from hardware.pouring.run_log import RunLog, read_states

STILL = np.zeros(6)


def a_state(controller_s, joints_rad=STILL):
    pose = np.eye(4)
    return RobotState(
        joints_rad, joints_rad, np.zeros(6), pose, pose, RobotMode.RUNNING, SafetyMode.NORMAL, True,
        (True, False), 1.0, controller_s, 0.0,
    )  # fmt: skip


def test_states_are_kept_25_times_a_second_of_the_controllers_clock(tmp_path):
    with RunLog(tmp_path / "run") as log:
        for k in range(251):
            log.state("carry" if k < 125 else "pour", a_state(k * 0.008, np.full(6, k * 0.001)))
    states = read_states(tmp_path / "run", {"carry", "pour"})
    assert len(states.times_s) == 51
    assert np.diff(states.times_s) == pytest.approx(0.04)
    assert states.joints_rad[-1] == pytest.approx(np.full(6, 0.25))
    assert read_states(tmp_path / "run", {"pour"}).times_s[0] >= 1.0


def test_an_event_is_on_the_disk_before_the_next_line_runs(tmp_path):
    with RunLog(tmp_path / "0001") as log:
        log.event("move", "carry: 3.0 s.", index=3, name="carry", phase="carry")
        run = PourRun.load(tmp_path / "0001")
        assert [event["name"] for event in run.events] == ["carry"]
        assert run.sentence == "The run ended without a word: the program was ended while the arm moved."
        log.event("stopped", "The controller stopped the arm.", error="ProtectiveStop", index=3)
    assert (
        PourRun.load(tmp_path / "0001").sentence == "Stopped during 'carry': The controller stopped the arm."
    )


def test_every_event_and_the_name_of_its_file_are_synced_to_the_disk(tmp_path, monkeypatch):
    """What a power cut leaves is what was synced: the file's content as it was then, and names in folders."""
    kept, names, sync = {}, set(), os.fsync

    def noted(descriptor):
        sync(descriptor)
        path = Path(f"/proc/self/fd/{descriptor}").resolve()
        if path.is_dir():
            names.update(path.iterdir())
        else:
            kept[path] = path.read_text()

    monkeypatch.setattr(os, "fsync", noted)
    folder = tmp_path / "session" / "pours" / "0001"
    (tmp_path / "session").mkdir()
    events = folder / "events.jsonl"
    with RunLog(folder) as log:
        assert {events, folder, folder.parent} <= names
        for k in range(20):
            log.event("move", f"move {k}", index=k)
            lines = kept[events].splitlines()
            assert [json.loads(line)["index"] for line in lines] == list(range(k + 1))
        log.stopped(RuntimeError("it broke"), None)
        assert json.loads(kept[events].splitlines()[-1])["kind"] == "stopped"


def test_a_line_that_a_crash_cut_short_hides_nothing_before_it(tmp_path):
    with RunLog(tmp_path) as log:
        log.event("done", "All moves were made.")
    with (tmp_path / "events.jsonl").open("a") as file:
        file.write('{"time": "2026-01-')
    run = PourRun.load(tmp_path)
    assert len(run.events) == 1
    assert run.is_done


def test_runs_are_numbered_and_keep_their_outcome(tmp_path):
    for _ in range(2):
        with RunLog(next_run_folder(tmp_path)) as log:
            log.event("done", "All moves were made.")
    assert [run.folder.name for run in pour_runs(tmp_path)] == ["0001", "0002"]
    assert next_run_folder(tmp_path).name == "0003"
    write_outcome(tmp_path / "pours" / "0002", Outcome(60, 2, "One rolled off.", False, {}))
    first, second = pour_runs(tmp_path)
    assert first.outcome is None
    assert second.outcome.sentence == "2 of 60 candies were spilled. One rolled off."
