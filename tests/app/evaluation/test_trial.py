"""One trial from the mesh to the poured candies."""

from dataclasses import replace

import pytest

from app.evaluation.trial import TrialTask, run_trial
from core.evaluation.variants import variants_of
from core.parameters import Parameters, apply_settings
from core.ply import write_ply
from hardware.simulation.objects import builtin_object
from hardware.simulation.pour_outcome.settings import OutcomeSettings

QUICK = {
    "pouring.n_pour": 15,
    "containability.verdict": "omega",
    "risk.n_tries": 4,
    "containability.omega_threshold": 0.1,
    "collision.max_faces": 1000,
}


@pytest.fixture
def task(tmp_path):
    def of(name: str, label: str, *variants: str) -> TrialTask:
        write_ply(tmp_path / f"{name}.ply", builtin_object(name))
        return TrialTask(
            name,
            label,
            False,
            (tmp_path / f"{name}.ply").read_bytes(),
            ".ply",
            "mesh",
            apply_settings(Parameters(), QUICK),
            variants_of(list(variants)),
            OutcomeSettings(),
            1,
        )

    return of


def test_a_bowl_is_judged_poured_into_and_pictured(task):
    result = run_trial(task("bowl", "container", "imagination"))
    (trial,) = result.trials
    assert trial.is_judged_container
    assert trial.is_right
    assert trial.p_chosen > 0.9
    assert len(trial.spilled) == 1
    assert trial.n_pour == 15
    stages = {"mesh", "scan", "collision", "containability", "pouring", "risk", "outcome"}
    assert set(trial.seconds) == stages
    assert result.pictures[trial.picture].startswith(b"\x89PNG")


def test_a_block_is_not_poured_into(task):
    (trial,) = run_trial(task("block", "non-container", "imagination")).trials
    assert (trial.is_judged_container, trial.spilled, trial.p_chosen) == (False, (), None)


def test_variants_share_what_they_have_in_common(task):
    both = run_trial(task("bowl", "container", "imagination", "fixed-theta", "threshold-0")).trials
    plain, fixed, zero = both
    assert (plain.n_in, plain.n_drop) == (fixed.n_in, fixed.n_drop) == (zero.n_in, zero.n_drop)
    assert "containability" not in fixed.seconds
    assert "pouring" in fixed.seconds
    assert zero.seconds == {}, "the same drop and the same pours, held against another threshold"
    assert zero.spilled == plain.spilled
    assert zero.threshold == 0


def test_what_cannot_be_judged_says_why(task):
    broken = replace(task("bowl", "container", "imagination"), content=b"no mesh", ending=".obj")
    (trial,) = run_trial(broken).trials
    assert trial.omega is None
    assert trial.is_right is False
    assert "object.obj" in trial.problem
