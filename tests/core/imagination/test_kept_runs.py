"""Runs of the cup that are kept: the same to the last bit, bounded, whole whatever happens to programs."""

from __future__ import annotations

import os
import subprocess
import sys
from contextlib import contextmanager
from dataclasses import fields

import numpy as np
import pytest

from core.imagination.context import ImaginationContext
from core.imagination.cup_run import CupRun
from core.imagination.cup_runs import CupRuns
from core.imagination.kept_runs import KeptRuns
from core.imagination.recording import Recording
from core.imagination.risk.ahead import CupRunsAhead, set_ups_ahead
from core.imagination.set_up import as_planned
from core.parameters import apply_settings
from core.progress import Reporter
from core.workers import RunHere
from tests.patience import wait_until


class CountingRunner(RunHere):
    def __init__(self):
        self.n_tasks = 0

    def run(self, tasks, *others):
        self.n_tasks += len(tasks)
        return super().run(tasks, *others)


def arrays_of(run):
    recording = run.recording
    return [
        run.release_steps,
        run.poses,
        run.velocities,
        *(getattr(recording, f.name) for f in fields(recording)),
    ]


def a_run(number=0, n_moments=3):
    generator = np.random.default_rng(number)
    single = generator.normal(size=(n_moments, 2, 7)).astype(np.float32)
    recording = Recording(np.arange(n_moments, dtype=np.float32), single[..., :3], single[..., 3:],
                          np.zeros((n_moments, 4, 4), np.float32))  # fmt: skip
    return CupRun(np.array([3, -1]), generator.normal(size=(2, 7)), generator.normal(size=(2, 6)), recording)


def context_of(parameters):
    return ImaginationContext(parameters, CountingRunner(), Reporter())


def test_a_second_session_computes_no_run_again_and_gets_the_same_to_the_last_bit(quick, tmp_path):
    first, second = context_of(quick), context_of(quick)
    computed = CupRuns(KeptRuns(tmp_path)).of(first, [as_planned(0)])
    found = CupRuns(KeptRuns(tmp_path)).of(second, [as_planned(0)])
    assert first.runner.n_tasks == 1 and second.runner.n_tasks == 0
    for one, other in zip(arrays_of(computed[0]), arrays_of(found[0]), strict=True):
        assert one.dtype == other.dtype and one.tobytes() == other.tobytes()


@pytest.mark.parametrize(
    "setting",
    [{"seed": 5}, {"pouring.n_pour": 7}, {"pouring.turn_s": 1.9}, {"particle.mass_kg": 0.0012},
     {"pouring.contact.restitution": 0.4}, {"solver.rate_hz": 480}],
)  # fmt: skip
def test_other_settings_are_another_run(quick, tmp_path, setting):
    kept = KeptRuns(tmp_path)
    shared = CupRuns(kept)
    shared.of(context_of(quick), [as_planned(0)])
    changed = context_of(apply_settings(quick, setting))
    shared.of(changed, [as_planned(0)])
    assert changed.runner.n_tasks == 1 and kept.size()[0] == 2


def test_what_was_computed_ahead_is_all_that_a_pour_without_a_spill_asks_for(quick, tmp_path):
    ahead = CupRunsAhead(context_of(quick), CupRuns(KeptRuns(tmp_path)))
    while ahead.make_some():
        pass
    wanted = set_ups_ahead(quick)
    assert len(wanted) > 1
    later = context_of(quick)
    CupRuns(KeptRuns(tmp_path)).of(later, wanted)
    assert later.runner.n_tasks == 0
    of_the_object = apply_settings(quick, {"pouring.amount": "half"})
    assert set_ups_ahead(of_the_object) == [], "how much a cup will hold is not known yet"


@pytest.mark.parametrize("content", [b"", b"PK\x03\x04 torn", b"no archive at all"])
def test_a_damaged_run_is_computed_again(quick, tmp_path, content):
    kept = KeptRuns(tmp_path)
    CupRuns(kept).of(context_of(quick), [as_planned(0)])
    (file,) = tmp_path.iterdir()
    file.write_bytes(content)
    again = context_of(quick)
    CupRuns(kept).of(again, [as_planned(0)])
    assert again.runner.n_tasks == 1 and file.read_bytes() != content


def test_a_folder_that_cannot_be_written_is_no_error(quick, tmp_path):
    in_the_way = tmp_path / "file"
    in_the_way.write_text("")
    kept = KeptRuns(in_the_way / "runs")
    assert len(CupRuns(kept).of(context_of(quick), [as_planned(0)])) == 1
    assert kept.size() == (0, 0)


def test_the_oldest_go_first_and_what_was_wanted_again_is_not_old(tmp_path):
    one_file = 4_000
    kept = KeptRuns(tmp_path, most_bytes=10 * one_file)
    for number in range(8):
        kept.store(str(number), a_run(number))
        path = max(tmp_path.iterdir(), key=lambda file: file.stat().st_mtime_ns)
        os.utime(path, (1000 + number, 1000 + number))
    assert kept.fetch("0") is not None
    for number in range(8, 40):
        kept.store(str(number), a_run(number))
    n_runs, n_bytes = kept.size()
    assert 0 < n_runs < 40 and n_bytes <= 10 * one_file
    assert kept.fetch("1") is None and kept.fetch("39") is not None
    kept.empty()
    assert kept.size() == (0, 0) and kept.fetch("39") is None


WRITER = """
import sys
from pathlib import Path
from tests.core.imagination.test_kept_runs import a_run
from core.imagination.kept_runs import KeptRuns
kept = KeptRuns(Path(sys.argv[1]))
print("ready", flush=True)
while True:
    for number in range(5):
        kept.store(str(number), a_run(number, n_moments=400))
"""


@contextmanager
def writing_program(folder):
    """A program that writes the same runs again and again, until it is killed."""
    writer = subprocess.Popen([sys.executable, "-c", WRITER, str(folder)], stdout=subprocess.PIPE, text=True)
    try:
        assert writer.stdout.readline() == "ready\n"
        yield
    finally:
        writer.kill()
        writer.wait()
        writer.stdout.close()


@pytest.mark.system
def test_programs_that_share_the_folder_and_are_killed_leave_whole_runs(tmp_path):
    kept = KeptRuns(tmp_path)
    for _ in range(3):
        with writing_program(tmp_path), writing_program(tmp_path):
            wait_until(lambda: kept.size()[0] == 5)
            for _ in range(50):
                for number in range(5):
                    found = kept.fetch(str(number))
                    assert found is not None
                    assert found.poses.tobytes() == a_run(number, 400).poses.tobytes()
        assert all(kept.fetch(str(number)) is not None for number in range(5))
