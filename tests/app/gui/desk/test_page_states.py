"""What the tabs say, and what comes next."""

from __future__ import annotations

import json
import shutil

import pytest

from app.gui.desk.page_states import PageState, page_states, with_failure
from app.gui.pages.robot.steps import missing_for_a_pour
from app.gui.shell.job_bar import next_step
from core.session.pour_runs import Outcome, write_outcome


def _next(workspace, shown="scan"):
    step = next_step(page_states(workspace, None), workspace.is_container, shown, workspace.is_undecided)
    return None if step is None else step.page


def test_without_a_session_everything_is_empty(desk):
    assert {state.word for state in page_states(desk.workspace, None).values()} == {"empty"}


def test_figures_show_what_was_found(desk, mug_session):
    desk.workspace.open(mug_session)
    states = page_states(desk.workspace, None)
    assert states["scan"].figure == "24 views"
    assert states["imagination"].figure == "container"
    assert states["pours"].figure.endswith("%")


def test_the_tab_tells_the_chosen_pours_figure_not_the_best(desk, mug_session):
    desk.workspace.open(mug_session)
    i, j = desk.workspace.view.place
    path = mug_session / "pouring" / "pours.json"
    table = json.loads(path.read_text())
    table["p"] = [[1.0] * len(row) for row in table["p"]]
    table["p"][i][j] = 0.97
    path.write_text(json.dumps(table))
    _of_this_size(mug_session / "pouring", path)
    assert _read_anew(desk)["pours"].figure == "97 %"


def test_running_and_failed_pages_are_marked(desk, mug_session):
    desk.workspace.open(mug_session)
    states = with_failure(page_states(desk.workspace, "imagination"), "reconstruction")
    assert states["imagination"].word == "running"
    assert states["reconstruction"].word == "failed"


def test_a_scan_that_failed_its_check_is_marked_on_every_page(desk, mug_session):
    """The mug's scan, as if its views had disagreed."""
    path = mug_session / "quality" / "quality.json"
    reasons = ["scan again: the views do not agree."]
    path.write_text(json.dumps(json.loads(path.read_text()) | {"verdict": "scan again", "reasons": reasons}))
    _of_this_size(mug_session / "quality", path)
    desk.workspace.open(mug_session)
    states = page_states(desk.workspace, None)
    assert states["scan"] == PageState("failed", "scan again")
    for shown in states:
        step = next_step(states, True, shown)
        assert step is not None
        assert (step.page, step.words) == ("scan", "Next: scan the object again")


@pytest.mark.parametrize(
    ("stage", "file", "pages"),
    [
        ("quality", "quality.json", {"scan"}),
        ("containability", "containability.json", {"imagination"}),
        ("judgement", "judgement.json", {"imagination"}),
        ("pouring", "pours.json", {"pours"}),
    ],
)
def test_a_page_whose_files_are_damaged_is_marked_and_the_others_are_told(
    desk, mug_session, stage, file, pages
):
    """As long as it was, so that the stage is taken for whole."""
    path = mug_session / stage / file
    path.write_text("{" + " " * (path.stat().st_size - 2) + "}")
    desk.workspace.open(mug_session)
    states = page_states(desk.workspace, None)
    assert {page for page, state in states.items() if state == PageState("failed", "damaged")} == pages
    assert next_step(states, desk.workspace.is_container, "scan", desk.workspace.is_undecided) is not None


def test_a_verdict_is_told_while_the_pours_are_still_imagined(desk, mug_session):
    desk.workspace.open(mug_session)
    shutil.rmtree(mug_session / "pouring")
    desk.workspace.refresh()
    assert page_states(desk.workspace, "imagination")["imagination"] == PageState("running", "container")
    assert page_states(desk.workspace, "scan")["scan"] == PageState("running", ""), "they are taken anew"
    shutil.rmtree(mug_session / "judgement")
    desk.workspace.refresh()
    assert page_states(desk.workspace, "imagination")["imagination"] == PageState("running", "")


def test_a_pour_belongs_to_the_imagination_it_was_made_for(desk, mug_session):
    desk.workspace.open(mug_session)
    digest = desk.workspace.session.record("pouring").digest
    run = mug_session / "pours" / "0001"
    run.mkdir(parents=True)
    events = [{"kind": "confirmed", "time": "2026-01-01T00:00:00", "imagination": digest}, {"kind": "done"}]
    (run / "events.jsonl").write_text("\n".join(map(json.dumps, events)))
    assert _read_anew(desk)["robot"] == PageState("fresh", "poured")
    write_outcome(run, Outcome(60, 2, "", is_simulated=False, facts={}))
    assert _read_anew(desk)["robot"] == PageState("fresh", "2 spilled")
    (run / "events.jsonl").write_text(
        "\n".join(map(json.dumps, [events[0] | {"imagination": "old"}, events[1]]))
    )
    assert _read_anew(desk)["robot"].word == "stale"


def _read_anew(desk):
    desk.workspace.refresh()
    return page_states(desk.workspace, None)


def test_the_next_step_leads_through_the_work(desk, mug_session, tmp_path):
    desk.workspace.open(tmp_path / "new")
    assert _next(desk.workspace) == "scan"
    desk.workspace.open(mug_session)
    assert _next(desk.workspace) == "pours"
    assert _next(desk.workspace, shown="pours") == "robot"


def test_nothing_is_poured_into_what_is_no_container(desk, block_session):
    desk.workspace.open(block_session)
    assert desk.workspace.is_container is False
    assert _next(desk.workspace) is None
    assert page_states(desk.workspace, None)["imagination"].figure == "no container"


def test_what_was_not_seen_is_looked_at_again(desk, block_session):
    """The block's verdict, as if 90 ml behind an opening had not been seen."""
    path = block_session / "judgement" / "judgement.json"
    table = json.loads(path.read_text())
    verdict = {"capacity_share": 0.01, "threshold": 0.1, "n_candies": 0.0, "volume_ml": 0.0}
    verdict |= {"unseen_ml": 90.0, "other_share": 0.6}
    path.write_text(json.dumps(table | {"verdict": verdict}))
    _of_this_size(block_session / "judgement", path)
    desk.workspace.open(block_session)
    assert desk.workspace.is_container is False and desk.workspace.is_undecided
    assert page_states(desk.workspace, None)["imagination"].figure == "cannot tell"
    assert _next(desk.workspace, shown="imagination") == "scan"
    missing = missing_for_a_pour(desk.workspace, desk.workspace.is_container)
    assert missing is not None and missing.page == "scan"
    assert "no view saw" in missing.text


def _of_this_size(stage, path):
    """A stage is whole if its files have the sizes on its record."""
    record = stage / "record.json"
    table = json.loads(record.read_text())
    table["files"][path.name] = path.stat().st_size
    record.write_text(json.dumps(table))
