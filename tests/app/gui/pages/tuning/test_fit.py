"""Fit on the Tune page: chosen, run in a host process, shown, kept as a set and as a preset."""

from types import SimpleNamespace

import pytest
from PySide6.QtWidgets import QCheckBox, QComboBox, QLabel, QLineEdit, QPushButton, QSpinBox

from app.gui.pages import saved_presets
from app.gui.pages.tuning.fit_texts import fitted_title, range_text, score_sentence, value_text
from app.gui.pages.tuning.page import TuningPage
from app.jobs.messages import Failed, FailureKind
from app.jobs.tuning_work import FitStepped, FitTask
from app.library import places
from app.operations.tuning_board import load_board
from core.evaluation.fitting.fitted import ROLLING, fitted_parameters
from core.evaluation.fitting.provenance import read_provenance
from core.evaluation.fitting.scores import CaseScore, FitScore
from core.evaluation.fitting.search import FitStep, FitTrial
from core.evaluation.verdicts import ObjectVerdict
from core.mesh_file import write_ply
from core.parameters import Parameters, apply_settings, flatten, load_preset
from hardware.simulation.objects import builtin_object

pytestmark = pytest.mark.system

QUICK = {
    "containability.verdict": "omega",
    "containability.n_max": 30,
    "containability.n_min": 10,
    "containability.rotation_s": 0.5,
    "solver.substeps": 2,
}
FRICTION = "containability.contact.lateral_friction"
ROWS = "id,label,calib\nmug,container,1\nbowl,container,\nblock,non-container,1\nbottle,ambiguous,1\n"


@pytest.fixture(autouse=True)
def own_folders(monkeypatch, tmp_path):
    monkeypatch.setenv("XDG_DATA_HOME", str(tmp_path / "data"))
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path / "config"))


@pytest.fixture
def folder(tmp_path):
    folder = tmp_path / "objects"
    folder.mkdir()
    for name in ("mug", "bowl", "block", "bottle"):
        write_ply(folder / f"{name}.ply", builtin_object(name))
    (folder / "labels.csv").write_text(ROWS)
    return folder


@pytest.fixture
def page(desk, qtbot, folder):
    page = TuningPage(desk)
    qtbot.addWidget(page)
    page.resize(1060, 640)
    page.show()
    page.open(folder)
    qtbot.waitUntil(lambda: desk.background.is_idle and page._board is not None)
    page._edit(apply_settings(Parameters(), QUICK))
    page.findChild(QPushButton, "fit").click()
    return page


def choose(page, n_trials, names=(FRICTION,)):
    for box in page.findChildren(QCheckBox):
        if box.objectName().startswith("fit_") and "." in box.objectName():
            box.setChecked(box.objectName().removeprefix("fit_") in names)
    source = page.findChild(QComboBox, "fit_input")
    source.setCurrentIndex(source.findData("mesh"))
    page.findChild(QSpinBox, "fit_seeds").setValue(1)
    page.findChild(QSpinBox, "fit_trials").setValue(n_trials)


def text(page, name):
    return page.findChild(QLabel, name).text()


def start(page):
    page.findChild(QPushButton, "fit_start").click()


def step(number, margin, best, n_trials=5, values=None):
    score = FitScore((CaseScore("mug", True, 0, 0.2 + margin), CaseScore("block", False, 0, 0.2)))
    trial = FitTrial(number, values or {FRICTION: 0.1 * (number + 1)}, score)
    return FitStep(trial, best or trial, n_trials, {FRICTION: 1.0} if number else {})


def test_what_is_chosen_is_said(page):
    assert text(page, "fit_objects") == "2 objects; containers: 1, others: 1."
    page.findChild(QCheckBox, "fit_all").setChecked(True)
    assert text(page, "fit_objects") == "3 objects; containers: 2, others: 1."
    task = page._fit.side.task((), "default", Parameters())
    assert len(task.fitted) == 4 and task.source == "scan" and page._fit.side.is_all
    choose(page, 7)
    task = page._fit.side.task((), "default", Parameters())
    assert [one.name for one in task.fitted] == [FRICTION]
    assert (task.source, task.n_seeds, task.n_trials) == ("mesh", 1, 7)


def test_the_time_of_a_fit_is_said_before_it_begins(page, monkeypatch):
    monkeypatch.setattr("app.gui.pages.tuning.fit.usable_processors", lambda: 2)
    assert text(page, "fit_time").startswith("'Run all' first")
    board, one = page._board.with_set(Parameters())
    for name in ("mug", "block"):
        board = board.with_verdict(one.key, ObjectVerdict(name, "", 90, 45, seconds=6.0))
    page._show(board)
    choose(page, 40)
    assert text(page, "fit_time").startswith("Takes about 4 min at most: 80 times 6.0 s, 2 at a time.")
    page.findChild(QSpinBox, "fit_seeds").setValue(2)
    assert text(page, "fit_time").startswith("Takes about 8 min at most: 160 times 6.0 s")
    source = page.findChild(QComboBox, "fit_input")
    source.setCurrentIndex(source.findData("scan"))
    assert text(page, "fit_time").endswith("Scanning the objects once comes on top.")


def test_objects_of_one_kind_cannot_be_fitted_to(page, folder):
    (folder / "labels.csv").write_text("id,label\nmug,container\n")
    page._show(load_board(folder))
    assert "label both kinds" in text(page, "fit_objects")
    assert not page.findChild(QPushButton, "fit_start").isEnabled()


def test_a_fit_becomes_a_set_and_a_preset_with_its_provenance(page, qtbot):
    choose(page, 3)
    with qtbot.waitSignal(page.desk.jobs.finished):
        start(page)
        assert not page.findChild(QPushButton, "fit_start").isEnabled()
        assert text(page, "fit_verdict") == "Preparing the objects …"
    qtbot.waitUntil(lambda: page.desk.background.is_idle)
    assert len(page._fit.view.chart.steps) == 3
    assert text(page, "fit_verdict").startswith("Done after 3 trials: margin")
    (one,) = page._board.sets
    assert one.provenance.objects == {"mug": "container", "block": "non-container"}
    assert page._draft[1] == one.parameters
    assert "fitted" in page._view.sets.rows[0].values[0]
    assert one.provenance.sentence in page._view.sets.rows[0].tooltip

    page.findChild(QPushButton, "fit_back").click()
    assert page.findChild(QPushButton, "fit").isVisibleTo(page)
    again = load_board(page._board.source)
    assert again.sets == page._board.sets, "provenance and all"

    page.findChild(QLineEdit, "preset_name").setText("Slick")
    page.findChild(QPushButton, "save_preset").click()
    path = places.presets_folder() / "slick.json"
    assert read_provenance(path) == one.provenance
    assert flatten(load_preset(str(path)))[FRICTION] == flatten(one.parameters)[FRICTION]
    names = saved_presets.preset_names()
    assert names.count(str(path)) == 1
    assert "Fitted on" in saved_presets.preset_tips(names)[str(path)]


def test_cancel_keeps_the_best(page, qtbot):
    choose(page, 1000)
    start(page)
    qtbot.waitUntil(lambda: bool(page._fit.view.chart.steps))
    with qtbot.waitSignal(page.desk.jobs.finished):
        page.desk.jobs.cancel()
    assert "the best is kept" in text(page, "fit_verdict")
    assert page._board.sets[0].provenance.search["is_cut_short"] is True


def test_what_was_found_outlives_its_process(page):
    fitted = fitted_parameters([FRICTION])
    first = step(0, 0.1, None)
    page._fit._task = FitTask((), "mesh", 1, page._draft[1], "default", fitted, 5)
    page._fit.view.begin(fitted, page._draft[1], 5)
    page._fit._hear(FitStepped(first))
    page._fit._hear(FitStepped(step(1, 0.3, None)))
    died = Failed(FailureKind.DIED, "It died.", "", "WorkerError")
    page._fit._fail(SimpleNamespace(page=page.KEY), died)
    (one,) = page._board.sets
    assert one.provenance is None
    assert flatten(one.parameters)[FRICTION] == 0.2
    assert one.threshold == pytest.approx(0.35)


def test_each_trial_is_shown(page):
    fitted = fitted_parameters([FRICTION])
    page._fit._task = FitTask((), "mesh", 1, page._draft[1], "default", fitted, 5)
    page._fit.view.begin(fitted, page._draft[1], 5)
    assert page._fit.view.values.rows[0].values[2] is None
    first = step(0, 0.1, None)
    page._fit._hear(FitStepped(first))
    assert text(page, "fit_verdict") == "Trial 1 of 5. Nothing beats the start yet: margin 0.100."
    page._fit._hear(FitStepped(step(1, 0.05, first.trial)))
    page._fit._hear(FitStepped(step(2, 0.3, None)))
    assert text(page, "fit_verdict") == "Trial 3 of 5. Best so far: trial 3 with a margin of 0.300."
    assert "Smallest Omega of a container: 0.500 (mug); largest of another object: 0.200 (block)." in text(
        page, "fit_detail"
    )
    row, threshold = page._fit.view.values.rows
    assert row.values[2:] == ("0.3", "100 %")
    assert threshold.values[2] == "0.35"
    assert "3 trials, best margin 0.300" in page._fit.view.chart.accessibleDescription()


def test_what_judges_is_shown(page):
    """By capacity nothing speaks of Omega, and the threshold that is kept is the capacity's."""
    assert text(page, "fit_measure").startswith("Judged by Omega.")
    page._edit(apply_settings(page._draft[1], {"containability.verdict": "capacity"}))
    assert text(page, "fit_measure").startswith("Judged by capacity share.")
    page._fit._task = FitTask((), "mesh", 1, page._draft[1], "default", (), 1)
    page._fit.view.begin((), page._draft[1], 1)
    page._fit._hear(FitStepped(step(0, 0.3, None, 1, {"unused": 0.0})))
    (threshold,) = page._fit.view.values.rows
    assert threshold.values[:3] == ("Threshold (capacity share)", "0.1", "0.35")
    assert page._fit.view.chart._plot.getAxis("left").labelText == "Margin (capacity share)"
    assert "Smallest capacity share of a container: 0.500 (mug)" in text(page, "fit_detail")
    page._fit._fail(SimpleNamespace(page=page.KEY), Failed(FailureKind.DIED, "It died.", "", "WorkerError"))
    (one,) = page._board.sets
    assert one.measure == "Capacity share" and one.threshold == pytest.approx(0.35)
    assert one.parameters.containability.capacity_threshold == one.threshold


def test_return_presses_the_button_that_is_seen(page):
    pressed = []
    page._fit.side.primary.clicked.connect(lambda: pressed.append("fit"))
    page._fit.side.primary.clicked.disconnect(page._fit.start)
    page.press_primary()
    assert pressed == ["fit"]


def test_words():
    (one,) = fitted_parameters(["containability.rotation_rad"])
    assert range_text(one) == "1 to 20°" and value_text(one.name, 0.2) == "11.5°"
    assert fitted_title(fitted_parameters([ROLLING])[0]) == "Rolling and spinning friction"
    assert value_text("particle.diameter_m", 0.0132) == "13.2 mm"
    overlapping = FitScore((CaseScore("mug", True, 0, 0.1), CaseScore("can", False, 0, 0.3)))
    said = score_sentence(overlapping, "Omega")
    assert "They overlap" in said and "50.0 %" in said
    assert "Smallest capacity share of a container: 0.100" in score_sentence(overlapping, "Capacity share")
