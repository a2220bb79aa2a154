"""An evaluation is continued, not repeated; only what is decisive makes a trial again."""

import os
import tempfile

import pytest
from filelock import FileLock

from app.operations import evaluating
from app.operations.evaluating import evaluate, interleaved, prepared_objects
from core.errors import Cancelled, InputError, SessionError
from core.evaluation.evaluation import Evaluation
from core.evaluation.variants import variants_of
from core.parameters import Parameters, apply_settings
from core.progress import Reporter
from tests.app.operations.evaluation.fakes import Here, request_for, write_fake, write_labels


@pytest.fixture
def objects(tmp_path):
    """Three objects and their labels."""
    folder = tmp_path / "objects"
    for name in ("mug", "bowl", "block"):
        write_fake(folder, name)
    write_labels(folder, mug="container", bowl="container", block="non-container")
    return folder


@pytest.fixture
def run(objects, tmp_path):
    """Evaluate into one folder: returns the names that were computed, and the evaluation."""

    def once(**changes):
        engine = Here()
        found = evaluate(request_for(objects, **changes), engine, tmp_path / "out", Reporter())
        return [name for name, _, _ in engine.done], found

    return once


def test_what_is_finished_is_not_repeated(run, tmp_path):
    computed, first = run()
    assert sorted(computed) == ["block", "bowl", "mug"]
    assert [trial.name for trial in first.trials] == ["mug", "bowl", "block"], "in the order of the labels"
    picture = tmp_path / "out" / "pictures" / first.trials[0].picture
    assert picture.read_bytes() == b"picture of mug.0.imagination.png"
    computed, again = run()
    assert computed == []
    assert again.trials == first.trials
    assert again.seconds >= first.seconds, "the seconds of all runs add up"


def test_what_a_killed_one_left_in_the_temporary_folder_goes_though_nothing_is_to_be_done(
    run, tmp_path, monkeypatch
):
    run()
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    left = tmp_path / "poursight-left"
    left.mkdir()
    (left / ".held").touch()
    os.utime(left / ".held", (0, 0))
    computed, _ = run()
    assert computed == []
    assert not left.exists()


@pytest.mark.parametrize(
    "change",
    [
        {"parameters": apply_settings(Parameters(), {"containability.rotation_rad": 0.123})},
        {"n_pours": 2},
        {"source": "scan"},
    ],
)
def test_a_change_that_decides_repeats_all(run, change):
    run()
    computed, found = run(**change)
    assert len(computed) == len(found.trials) == 3


def test_another_version_of_the_result_repeats_all(run, monkeypatch):
    run()
    monkeypatch.setattr(evaluating, "RESULT_VERSION", evaluating.RESULT_VERSION + 1)
    assert len(run()[0]) == 3


def test_more_seeds_and_variants_do_only_what_is_new(objects, run, tmp_path):
    run()
    engine = Here()
    request = request_for(objects, seeds=(0, 1), variants=variants_of(["imagination", "fixed-theta"]))
    found = evaluate(request, engine, tmp_path / "out", Reporter())
    assert {(seed, variants) for _, seed, variants in engine.done} == {
        (0, ("fixed-theta",)),
        (1, ("imagination", "fixed-theta")),
    }
    assert len(engine.done) == 6
    assert len(found.trials) == 12
    assert found.trials[0].seed == 0
    assert found.trials[1].seed == 1


def test_a_changed_mesh_is_done_again_alone(run, objects):
    run()
    write_fake(objects, "bowl", anything="else")
    assert run()[0] == ["bowl"]


def test_a_changed_label_costs_nothing(run, objects):
    run()
    write_labels(objects, mug="container", bowl="non-container", block="non-container")
    computed, found = run()
    assert computed == []
    assert [trial.label for trial in found.trials] == ["container", "non-container", "non-container"]
    assert [trial.is_right for trial in found.trials] == [True, False, True]


def test_a_missing_mesh_is_a_row_until_it_is_there(run, objects):
    (objects / "bowl.obj").unlink()
    computed, found = run()
    assert sorted(computed) == ["block", "mug"]
    assert "bowl.obj cannot be read (No such file or directory)" in found.trials[1].problem
    write_fake(objects, "bowl")
    computed, found = run()
    assert computed == ["bowl"]
    assert found.trials[1].problem == ""


def test_what_failed_is_tried_again(run, objects):
    write_fake(objects, "mug", problem="It could not be judged.")
    assert run()[1].trials[0].problem == "It could not be judged."
    assert run()[0] == ["mug"]


def test_what_is_damaged_is_made_anew(run, tmp_path):
    _, first = run()
    (tmp_path / "out" / "evaluation.json").write_text("{")
    (tmp_path / "out" / "trials" / "bowl.0.imagination.json").write_text('{"key": 1, "trial": {}}')
    computed, found = run()
    assert computed == ["bowl"]
    assert [trial.name for trial in found.trials] == ["mug", "bowl", "block"]
    assert found.trials[0] == first.trials[0]


def test_an_interrupted_run_is_continued(objects, tmp_path):
    out, request = tmp_path / "out", request_for(objects)
    with pytest.raises(Cancelled, match="finished trials are kept"):
        evaluate(request, Here(stop_after=2), out, Reporter())
    before = Evaluation.load(out)
    assert len(before.trials) == 2
    assert before.seconds > 0
    engine = Here()
    found = evaluate(request, engine, out, Reporter())
    assert len(engine.done) == 1
    assert len(found.trials) == 3
    assert found.seconds > before.seconds


def test_an_interrupted_run_shows_nothing_of_another_input(run, objects, tmp_path):
    run()
    with pytest.raises(Cancelled):
        evaluate(request_for(objects, n_pours=2), Here(stop_after=1), tmp_path / "out", Reporter())
    assert len(Evaluation.load(tmp_path / "out").trials) == 1


def test_progress_shows_what_remains(objects, tmp_path):
    class Recorder(Reporter):
        def __init__(self):
            super().__init__()
            self.seen, self.said = [], []

        def progress(self, stage, done, total):
            self.seen.append((stage, done, total))

        def warn(self, sentence):
            self.said.append(sentence)

    reporter = Recorder()
    evaluate(request_for(objects), Here(), tmp_path / "out", reporter)
    assert reporter.seen == [("evaluation", done, 3) for done in range(4)]
    assert reporter.said == []
    reporter = Recorder()
    evaluate(request_for(objects, seeds=(0, 1)), Here(), tmp_path / "out", reporter)
    assert reporter.seen[-1] == ("evaluation", 3, 3)
    assert reporter.said == ["3 trials were finished before and are kept."]


def test_a_folder_in_use_is_refused(objects, tmp_path):
    out = tmp_path / "out"
    out.mkdir()
    with FileLock(out / ".lock"), pytest.raises(SessionError, match="Another evaluation writes into"):
        evaluate(request_for(objects), Here(), out, Reporter())
    assert not (out / "evaluation.json").exists()


def test_folders_that_cannot_be_used(objects, tmp_path):
    (tmp_path / "file").write_text("")
    for out in (tmp_path / "file", tmp_path / "file" / "out"):
        with pytest.raises(InputError, match="there is a file; choose another"):
            evaluate(request_for(objects), Here(), out, Reporter())


def test_names_that_lead_out_of_the_folder_are_refused(objects, tmp_path):
    write_labels(objects, **{"../mug": "container"})
    with pytest.raises(InputError, match="cannot be a file's name"):
        evaluate(request_for(objects), Here(), tmp_path / "out", Reporter())
    assert not (tmp_path / "out").exists()


def test_a_mesh_that_changes_meanwhile_is_reported(objects, tmp_path):
    class Meddling(Here):
        def run(self, tasks, reporter):
            for name in ("mug", "bowl", "block"):
                os.utime(objects / f"{name}.obj")  # its time alone does not matter
            write_fake(objects, "block", anything="else")
            yield from super().run(tasks, reporter)

    with pytest.raises(InputError, match=r"block.obj has changed since the evaluation began"):
        evaluate(request_for(objects), Meddling(), tmp_path / "out", Reporter())


def test_kinds_are_spread_evenly(tmp_path):
    labels = {f"c{n}": "container" for n in range(4)} | {"n0": "non-container", "n1": "non-container"}
    write_labels(tmp_path, **labels)
    found = interleaved(prepared_objects(request_for(tmp_path)))
    assert [one.labelled.name for one in found] == ["c0", "n0", "c1", "c2", "n1", "c3"]
