"""What the answer and the report say was used is what was used, by the default verdict."""

import json

import pytest

from core.pipeline.freshness import Freshness, freshness
from core.pipeline.session_view import SessionView
from core.session import Session
from core.stages import stage
from tests.app.sessions import quick_parameters

pytestmark = pytest.mark.system

SETTINGS = {"holding.n_load": 8, "capacity.n_fillings": 2, "capacity.rain_m_s": 0.5}


@pytest.fixture
def words():
    return [word for name, value in SETTINGS.items() for word in ("--set", f"{name}={value}")]


def test_a_changed_judgement_is_made_anew_and_said(poursight, mug_session, words, tmp_path):
    before = {name: record.created for name, record in SessionView.of(mug_session).records.items()}
    digests = {name: record.digest for name, record in SessionView.of(mug_session).records.items()}
    answer = tmp_path / "answer.json"
    code, _, err = poursight("imagine", mug_session, *words, "--json", answer)
    assert code == 0, err
    table = json.loads(answer.read_text())
    assert {name: table["parameters"][name] for name in SETTINGS} == SETTINGS
    assert (table["holding"]["n_asked"], len(table["capacity"]["n_poured"])) == (8, 2)

    view = SessionView.of(mug_session)
    for name, value in SETTINGS.items():
        stage = "retention" if name.startswith("holding.") else "judgement"
        assert view.records[stage].parameters[name] == value
    assert view.records["judgement"].digest != digests["judgement"]
    assert view.records["containability"].created == before["containability"], "the drop reads none of them"
    assert view.retention.n_asked == 8
    assert set(freshness(view.session, view.parameters_of("judgement")).values()) >= {Freshness.FRESH}

    code, _, err = poursight("report", mug_session)
    assert code == 0, err
    page = (mug_session / "report.html").read_text(encoding="utf-8")
    assert "of 8 candies" in page or "8 candies" in page


def test_each_stage_records_what_it_reads(mug_session):
    session, parameters = Session.open(mug_session), quick_parameters()
    for name in (
        "reconstruction",
        "quality",
        "collision",
        "containability",
        "judgement",
        "amount",
        "pouring",
    ):
        recorded = session.record(name).parameters
        assert recorded == json.loads(json.dumps(stage(name).settings(parameters))), name
