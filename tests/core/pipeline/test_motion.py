"""The pour to make with an arm: tried with errors as well where the arm cannot make the one that was."""

import json

import numpy as np
import pytest

from core.motion.pour.feasibility import PourFeasibility
from core.parameters import Parameters, apply_settings
from core.pipeline import running
from core.pipeline.pipeline import Pipeline
from core.progress import Reporter
from core.session import Session
from core.workers import WorkerPool
from hardware.cell import read_cell
from hardware.cell.scene import pour_cell
from hardware.scanning.simulated import simulate_scan
from hardware.simulation.objects import builtin_object
from tests.app.quick_cell import quick_cell

QUICK = {
    "reconstruction.voxel_m": 0.005,
    "containability.n_max": 64,
    "containability.n_min": 40,
    "containability.rotation_s": 0.3,
    "containability.verdict": "omega",
    "pouring.n_pour": 10,
    "risk.n_tries": 8,
    "risk.sure": 0.99,
}


@pytest.fixture(scope="module")
def pool():
    with WorkerPool(2) as workers:
        yield workers


@pytest.fixture(scope="module")
def pipeline(tmp_path_factory, pool):
    """Imagined once; each test asks about an arm of its own."""
    with Session.create_or_open(tmp_path_factory.mktemp("motion") / "session") as session:
        scan = simulate_scan(builtin_object("bowl"), 0, Reporter(), cell=quick_cell())
        known = Pipeline(session, apply_settings(Parameters(), QUICK), pool, Reporter())
        known.keep_scan(scan, {"object": "bowl"})
        yield known


def arm_that_cannot(monkeypatch, *directions):
    """Makes every pour but those from some directions; which ones a real arm can is tested elsewhere."""

    def judge(*_):
        return tuple(
            PourFeasibility(i, j, i not in directions, "It is too far.", 0.02, 2.0, 20.0)
            for i in range(8)
            for j in range(3)
        )

    monkeypatch.setattr(running, "judge_pours", judge)


@pytest.mark.system
def test_the_pour_that_is_made_was_tried_even_if_it_was_not_the_first_choice(pipeline, monkeypatch):
    cell = pour_cell(read_cell())
    imagination = pipeline.imagination()
    free, known = imagination.choice, imagination.risk
    assert known.n_tries[free.i, free.j] > 1
    arm_that_cannot(monkeypatch, free.i)
    found = pipeline.motion(cell, {"cell": "one"})
    assert found.is_changed
    assert (found.free_choice.i, found.free_choice.j) == (free.i, free.j)
    choice, risk = found.choice, found.risk
    assert choice.i != free.i
    assert known.n_tries[choice.i, choice.j] == 1, "imagination alone had no reason to try it"
    assert risk.n_tries[choice.i, choice.j] > 1
    assert (risk.n_tries[free.i] == known.n_tries[free.i]).all()
    assert (risk.spilled[..., : known.spilled.shape[2]] == known.spilled)[known.n_tries > 1].all()
    again = pipeline.motion(cell, {"cell": "one"})
    assert np.array_equal(again.risk.spilled, risk.spilled)
    assert json.loads((pipeline.session.folder("risk") / "risk.json").read_text()) == known.to_table()


@pytest.mark.system
def test_an_arm_that_can_make_the_first_choice_costs_no_more_tries(pipeline, monkeypatch):
    cell = pour_cell(read_cell())
    imagination = pipeline.imagination()
    arm_that_cannot(monkeypatch, (imagination.choice.i + 4) % 8)
    found = pipeline.motion(cell, {"cell": "another"})
    assert not found.is_changed
    assert found.risk is None, "what is known of the pours is all there is"
    assert not (pipeline.session.folder("motion") / "risk.json").exists()
