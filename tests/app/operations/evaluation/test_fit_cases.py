"""Cases are prepared once; what cannot be is left out with its reason."""

import pytest

from app.operations.evaluation.fit_cases import prepare_cases, prepare_targets
from app.operations.tuning import chosen_parameters
from core.errors import InputError
from core.evaluation.fitting.fitted import CONTAINABILITY, POURING
from core.evaluation.labels import LabelledObject, objects_to_fit, read_labels
from core.mesh_file import write_ply
from core.parameters import Parameters, apply_settings
from core.progress import Reporter
from core.workers import RunHere
from hardware.simulation.objects import builtin_object

QUICK = {
    "reconstruction.voxel_m": 0.004,
    "containability.n_max": 30,
    "containability.n_min": 10,
    "solver.substeps": 2,
}
PARAMETERS = apply_settings(Parameters(), QUICK)


class Heard(Reporter):
    def __init__(self):
        super().__init__()
        self.sentences = []

    def warn(self, sentence):
        self.sentences.append(sentence)


@pytest.fixture
def objects(tmp_path):
    for name in ("mug", "block"):
        write_ply(tmp_path / f"{name}.ply", builtin_object(name))
    write_ply(tmp_path / "tower.ply", builtin_object("block"))
    (tmp_path / "labels.csv").write_text(
        "id,label,calib\nmug,container,1\nblock,non-container,1\nlost,container,1\nodd,ambiguous,1\n"
        "tower,non-container,\n"
    )
    return read_labels(tmp_path)


def names(objects):
    return [one.name for one in objects]


def test_the_objects_for_calibration_are_taken(objects):
    assert names(objects_to_fit(objects)) == ["mug", "block", "lost"]
    assert names(objects_to_fit(objects, all_of_them=True)) == ["mug", "block", "lost", "tower"]
    unmarked = [LabelledObject(one.name, one.label, one.mesh) for one in objects]
    assert names(objects_to_fit(unmarked)) == ["mug", "block", "lost", "tower"]
    with pytest.raises(InputError, match="only container among the 2 objects"):
        objects_to_fit([one for one in objects if one.label == "container"])


def test_a_mesh_is_the_same_with_every_seed(objects):
    heard = Heard()
    found = prepare_cases(objects_to_fit(objects), "mesh", (0, 1), PARAMETERS, RunHere(), heard)
    assert [(case.name, case.seed) for case in found.cases] == [
        ("mug", 0),
        ("mug", 1),
        ("block", 0),
        ("block", 1),
    ]
    assert found.cases[0].model is found.cases[1].model
    assert [case.is_container for case in found.cases] == [True, True, False, False]
    assert set(found.left_out) == {"lost"} and "cannot be read" in found.left_out["lost"]
    assert heard.sentences[0].startswith("lost is left out")


@pytest.mark.system
def test_a_scanned_object_is_known_as_it_was_seen(objects):
    block = [one for one in objects if one.name == "block"]
    (case,) = prepare_cases(block, "scan", (3,), PARAMETERS, RunHere(), Reporter()).cases
    assert (case.name, case.seed, case.is_container) == ("block", 3, False)
    true, seen = builtin_object("block").extents_m, case.model.surface.extents_m
    assert seen[2] == pytest.approx(true[2], abs=0.006)
    assert seen[:2] != pytest.approx(true[:2], abs=0.002), "it is placed at random"


def test_what_keeps_no_candy_cannot_be_poured_into(objects):
    targets = prepare_targets(objects[:1], PARAMETERS, RunHere(), Reporter())
    assert targets["mug"].footprint.center_m[2] > 0.05
    with pytest.raises(InputError, match="'block' cannot be imagined: no candy stays"):
        prepare_targets(objects[1:2], PARAMETERS, RunHere(), Reporter())


def test_what_is_named_replaces_the_usual_of_its_kind():
    for_labels, for_spills = chosen_parameters((), True)
    assert names(for_labels) == list(CONTAINABILITY) and names(for_spills) == list(POURING)
    for_labels, for_spills = chosen_parameters(["pouring.contact.restitution"], True)
    assert names(for_labels) == list(CONTAINABILITY) and names(for_spills) == ["pouring.contact.restitution"]
    assert chosen_parameters((), False)[1] == ()
    with pytest.raises(InputError, match="can be fitted to measured spills only"):
        chosen_parameters(["pouring.contact.restitution"], False)


def test_the_candy_is_measured_by_spills_where_there_are_any():
    size = ["particle.diameter_m"]
    assert names(chosen_parameters(size, False)[0]) == size
    assert names(chosen_parameters(size, True)[1]) == size
