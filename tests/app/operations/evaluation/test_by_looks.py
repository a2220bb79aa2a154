"""Judged and poured into by looks, in the simulated cell."""

from dataclasses import replace

import numpy as np
import pytest

from app.operations.evaluation.by_looks import LookedAt, touches
from app.operations.evaluation.ground_truth import ideal_path
from app.operations.evaluation.trial import TrialTask, run_trial
from core.appearance.pouring import OFFSET_M
from core.evaluation.variants import variants_of
from core.mesh_file import write_ply
from core.parameters import Parameters, apply_settings
from core.scan.model import Scan
from hardware.simulation.objects import builtin_object
from hardware.simulation.pour_outcome.settings import OutcomeSettings
from tests.core.appearance.looks import BOX, INTRINSICS, block_frame


def task(folder, name: str, label: str, *variants: str, source: str = "scan", n_pours: int = 1) -> TrialTask:
    write_ply(folder / f"{name}.ply", builtin_object(name))
    return TrialTask(
        name,
        label,
        False,
        (folder / f"{name}.ply").read_bytes(),
        ".ply",
        source,
        apply_settings(Parameters(), {"pouring.n_pour": 15}),
        variants_of(list(variants)),
        {"bullet": OutcomeSettings()},
        n_pours,
    )


@pytest.fixture(scope="module")
def bowl(tmp_path_factory):
    return run_trial(
        task(tmp_path_factory.mktemp("bowl"), "bowl", "container", "appearance", "appearance-3d")
    )


@pytest.mark.system
def test_a_bowl_looks_like_a_container_from_above_and_is_poured_into(bowl):
    offset, scanned = bowl.trials
    assert len(offset.view_scores) == 24
    assert offset.is_judged_container and offset.measure == "Appearance score"
    assert scanned.view_scores == offset.view_scores and scanned.top_down == offset.top_down == offset.view
    assert (offset.n_drop, offset.capacity_share, offset.p_chosen, offset.choice) == (0, None, None, None)
    assert set(offset.seconds) == {"mesh", "scan", "appearance", "outcome"}, "no physics before the pour"
    assert "appearance" not in scanned.seconds
    for trial in (offset, scanned):
        assert (trial.n_feasible, len(trial.spilled), trial.n_pour, trial.problem) == (1, 1, 15, "")
        assert trial.theta_rad == 0.0
        assert bowl.pictures[trial.picture].startswith(b"\x89PNG")


def test_views_that_look_into_openings_are_not_looked_at():
    frames = tuple(replace(block_frame(280, 200, 80, 80), name=f"frame-{k:06d}") for k in range(27))
    looked = LookedAt.of(Scan(frames, INTRINSICS, crop_box=BOX), Parameters().reconstruction)
    assert list(looked.facts["view_scores"]) == [frame.name for frame in frames[:24]]


def test_without_images_there_are_no_looks(tmp_path):
    (trial,) = run_trial(task(tmp_path, "bowl", "container", "appearance", source="mesh")).trials
    assert "'--input scan'" in trial.problem
    assert trial.score is None and not trial.is_right


@pytest.mark.system
def test_the_seed_decides_and_nothing_else(tmp_path, bowl):
    again = run_trial(task(tmp_path, "bowl", "container", "appearance", n_pours=0)).trials[0]
    assert again.view_scores == bowl.trials[0].view_scores
    other = task(tmp_path, "bowl", "container", "appearance", n_pours=0)
    moved = run_trial(replace(other, parameters=other.parameters.model_copy(update={"seed": 1}))).trials[0]
    assert moved.view_scores != again.view_scores


def test_the_cup_touches_what_is_higher_than_where_it_turns():
    """A vase of 200 mm: from above its rim it is clear; from the fixed height above its floor it is not."""
    vase, pouring = builtin_object("vase"), Parameters().pouring
    above = np.array([0.0, 0.0, vase.aabb_max_m[2] + 0.01])
    assert not touches(ideal_path(pouring, above, 0.0), pouring.cup, vase)
    inside = np.array([0.0, 0.0, 0.008 + OFFSET_M])
    assert touches(ideal_path(pouring, inside, 0.0), pouring.cup, vase)
