"""Measured spills are read or refused with a sentence, and values are found that explain them."""

import pytest

from core.collision import CollisionModel
from core.errors import InputError
from core.evaluation.fitting.containability import FitRequest
from core.evaluation.fitting.fitted import fitted_parameters
from core.evaluation.fitting.pours import PourTarget, fit_pours
from core.evaluation.fitting.spills import SpillMeasurement, read_spills, write_spills
from core.imagination.drop import imagine_drop
from core.parameters import Parameters, apply_settings
from core.progress import Reporter
from core.workers import RunHere
from hardware.simulation.objects import builtin_object
from tests.core.imagination.here import here

FRICTION = "pouring.contact.lateral_friction"
QUICK = {
    "containability.n_max": 30,
    "containability.n_min": 10,
    "containability.rotation_s": 0.2,
    "containability.rotation_rad": 0.05,
    "particle.shape": "cylinder",
    "particle.diameter_m": 0.012,
    "particle.height_m": 0.006,
    "particle.mass_kg": 0.0003,
    "pouring.contact.rolling_friction": 0.1,
    "pouring.contact.spinning_friction": 0.1,
    "pouring.contact.restitution": 0.0,
    "pouring.gamma_0_rad": 0.814,
    "pouring.n_packings": 1,
    "pouring.n_pour": 12,
    "solver.substeps": 2,
}


def csv_with(tmp_path, text):
    path = tmp_path / "spills.csv"
    path.write_text(text, encoding="utf-8")
    return path


def test_they_are_written_and_read(tmp_path):
    measured = (SpillMeasurement("mug", 0.5, 0.02, 3, 60, 7), SpillMeasurement("bowl", -1.25, 0.01, 0.5))
    path = tmp_path / "spills.csv"
    write_spills(path, measured)
    assert read_spills(path) == measured
    assert path.read_text().splitlines()[0] == "object,theta,indent,spilled,n_pour,seed"


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("", "lack the column object"),
        ("object,theta,spilled\nmug,0,1\n", "lack the column indent"),
        ("object,theta,indent,spilled\n", "hold no measurement"),
        ("object,theta,indent,spilled\n,0,0,1\n", "line 2 names no object"),
        ("object,theta,indent,spilled\nmug,north,0,1\n", "'north' in the column theta is no number"),
        ("object,theta,indent,spilled\nmug,0,0,\n", "'' in the column spilled is no number"),
        ("object,theta,indent,spilled\nmug,0,35,1\n", "none in metres"),
        ("object,theta,indent,spilled\nmug,0,0,-1\n", "cannot have been spilled"),
        ("object,theta,indent,spilled,n_pour\nmug,0,0,11,10\n", "cannot have been spilled"),
        ("object,theta,indent,spilled,seed\nmug,0,0,1,x\n", "no whole number"),
        ("object,theta,indent,spilled\nmug,0,nan,1\n", "is no number"),
    ],
)
def test_what_cannot_be_used(tmp_path, text, said):
    with pytest.raises(InputError, match=said):
        read_spills(csv_with(tmp_path, text))


def test_a_missing_file_is_a_sentence(tmp_path):
    with pytest.raises(InputError, match="cannot be read"):
        read_spills(tmp_path / "gone.csv")


@pytest.fixture(scope="module")
def target():
    mesh = builtin_object("bowl")
    model = CollisionModel("exact", (mesh,), mesh)
    return PourTarget(model, imagine_drop(here(quick()), model).footprint)


def quick(**settings):
    return apply_settings(Parameters(), QUICK | settings)


def request(parameters, n_trials=8):
    return FitRequest(parameters, fitted_parameters([f"{FRICTION}=0.05:0.8"]), n_trials)


def test_values_that_explain_the_spills_are_found(target):
    """What a friction of 0.5 spills far out is explained better by what is found than by the start."""
    places = [(theta, indent) for theta in (0.0,) for indent in (0.088, 0.09, 0.094)]
    rows = [SpillMeasurement("bowl", theta, indent, 0) for theta, indent in places]
    true = FitRequest(quick(**{FRICTION: 0.5}), (), 1)
    spilled = fit_pours(
        rows, {"bowl": target}, true, RunHere(), Reporter(), lambda _: None
    ).best.score.spilled
    assert sum(spilled) > 0, "nothing to learn from"
    measured = [
        SpillMeasurement("bowl", theta, indent, count)
        for (theta, indent), count in zip(places, spilled, strict=True)
    ]
    steps = []
    result = fit_pours(
        measured, {"bowl": target}, request(quick(**{FRICTION: 0.1}), 6), RunHere(), Reporter(), steps.append
    )
    assert result.best.score.rms < result.start.score.rms
    assert len(steps) == 6 and result.best.score.measured == spilled


def made_up(parameters, reporter):
    reporter.raise_if_cancelled()
    return [40 * parameters.pouring.contact.lateral_friction] * 2


def test_the_search_minimises_the_difference(target):
    rows = [SpillMeasurement("bowl", 0, 0.01, 8), SpillMeasurement("bowl", 0, 0.02, 8)]
    found = fit_pours(
        rows, {"bowl": target}, request(quick(), 30), RunHere(), Reporter(), lambda _: None, made_up
    )
    assert found.best.values[FRICTION] == pytest.approx(0.2, abs=0.02)
    assert found.best.score.rms < 1


@pytest.mark.parametrize(
    ("row", "said"),
    [
        (SpillMeasurement("pot", 0, 0.01, 1), "no such object can be poured into here; known: bowl"),
        (SpillMeasurement("bowl", 0, 0.01, 13), "13 of 12 candies cannot have been spilled"),
    ],
)
def test_rows_that_do_not_fit(target, row, said):
    with pytest.raises(InputError, match=said):
        fit_pours([row], {"bowl": target}, request(quick()), RunHere(), Reporter(), lambda _: None)
