"""One trial from the mesh to the poured candies."""

from dataclasses import replace

import numpy as np
import pytest

from app.operations.evaluation.trial import TrialTask, run_trial
from core.evaluation.variants import variants_of
from core.imagination.results import PourChoice
from core.mesh import TriangleMesh
from core.mesh_file import write_ply
from core.motion.pour.feasibility import PourMotions
from core.parameters import Parameters, apply_settings
from core.pipeline import running
from core.pipeline.running import StageRun
from hardware.simulation.objects import builtin_object
from hardware.simulation.pour_outcome.settings import OutcomeSettings

QUICK = {
    "pouring.n_pour": 15,
    "containability.verdict": "omega",
    "risk.n_tries": 4,
    "containability.omega_threshold": 0.1,
    "collision.max_faces": 1000,
}


@pytest.fixture(scope="module")
def task(tmp_path_factory):
    meshes = tmp_path_factory.mktemp("meshes")

    def of(name: str, label: str, *variants: str) -> TrialTask:
        write_ply(meshes / f"{name}.ply", builtin_object(name))
        return TrialTask(
            name,
            label,
            False,
            (meshes / f"{name}.ply").read_bytes(),
            ".ply",
            "mesh",
            apply_settings(Parameters(), QUICK),
            variants_of(list(variants)),
            {"bullet": OutcomeSettings()},
            1,
        )

    return of


@pytest.fixture(scope="module")
def of_a_bowl(task):
    """By the whole program, with a fixed direction, against another threshold, and without an arm."""
    return run_trial(task("bowl", "container", "imagination", "fixed-theta", "threshold-0", "ideal-arm"))


def by_variant(result):
    return {trial.variant: trial for trial in result.trials}


def test_a_bowl_is_judged_poured_into_and_pictured(of_a_bowl):
    trial = by_variant(of_a_bowl)["imagination"]
    assert trial.is_judged_container
    assert trial.is_right
    assert trial.p_chosen > 0.9
    assert len(trial.spilled) == 1
    assert trial.n_pour == 15
    assert 0 < trial.n_feasible <= 24
    judged = {"mesh", "scan", "collision", "containability", "judgement"}
    assert set(trial.seconds) == judged | {"pouring", "risk", "retention", "motion", "outcome"}
    assert of_a_bowl.pictures[trial.picture].startswith(b"\x89PNG")


@pytest.mark.system
def test_a_small_container_gets_what_safely_fits_and_whoever_wants_more_certainty_is_advised(task, tmp_path):
    bowl = builtin_object("bowl")
    write_ply(tmp_path / "half.ply", TriangleMesh(0.5 * bowl.vertices_m, bowl.faces))
    by_capacity = {"containability.verdict": "capacity", "pouring.n_pour": 80, "risk.wanted_clean": 0.9}
    quick = {"capacity.n_fillings": 1, "capacity.n_aimed": 20, "holding.n_load": 6, "risk.n_tries": 1}
    of_bowl = task("bowl", "container", "imagination")
    parameters = apply_settings(of_bowl.parameters, by_capacity | quick)
    content = (tmp_path / "half.ply").read_bytes()
    (trial,) = run_trial(replace(of_bowl, content=content, parameters=parameters)).trials
    assert trial.problem == ""
    assert 1 < trial.n_pour < trial.capacity_candies < 80
    assert len(trial.spilled) == 1
    assert trial.wanted_clean == 0.9
    assert trial.is_declined, "two clean trials are too few for 90 %"


def test_a_block_is_not_poured_into(task):
    (trial,) = run_trial(task("block", "non-container", "imagination")).trials
    assert (trial.is_judged_container, trial.spilled, trial.p_chosen) == (False, (), None)


def test_without_an_arm_the_same_pours_are_imagined_and_none_is_beyond_reach(of_a_bowl):
    by_arm, ideal = (by_variant(of_a_bowl)[name] for name in ("imagination", "ideal-arm"))
    assert "pouring" not in ideal.seconds
    assert "outcome" in ideal.seconds, "another path of the cup"
    assert (ideal.n_feasible, len(ideal.spilled)) == (None, 1)
    assert by_arm.n_feasible is not None


def test_an_arm_that_can_make_no_pour_makes_none(task, monkeypatch):
    none = PourMotions((), None, PourChoice(0, 0, 0.0, np.zeros(3), np.eye(4)), None)
    monkeypatch.setitem(running.RUNS, "motion", StageRun(lambda _: none, PourMotions.load))
    (trial,) = run_trial(task("bowl", "container", "imagination")).trials
    assert (trial.n_feasible, trial.n_pours, trial.problem) == (0, 0, "")
    assert trial.is_judged_container


def test_variants_share_what_they_have_in_common(of_a_bowl):
    plain, fixed, zero = (
        by_variant(of_a_bowl)[name] for name in ("imagination", "fixed-theta", "threshold-0")
    )
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
