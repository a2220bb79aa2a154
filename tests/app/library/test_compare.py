import json

import pytest

from app.library.compare import UNKNOWN, compare
from app.library.session_folder import PARAMETERS_FILE
from core.errors import PoursightError, SessionError
from core.mesh_file import write_ply
from core.session import Session
from core.session.operator_choice import write_operator_choice


@pytest.fixture
def rows(make_session):
    def of(a, b):
        return {(row.group, row.what): row for row in compare(a, b).rows}

    return of


def said(row):
    return row.a, row.b, row.difference


def test_a_session_equals_itself_in_everything(make_session):
    folder = make_session("mug")
    comparison = compare(folder, folder)
    assert comparison.a == comparison.b
    assert all(row.is_same and not row.difference for row in comparison.rows)


def test_numbers_have_units_and_differences_signs(make_session, rows, box):
    mug, bowl = make_session("mug"), make_session("bowl", kept=10, **{"pouring.n_pour": 40})
    with Session.open(bowl) as session:
        digest = session.record("scan").digest
        with session.writing("reconstruction", inputs={"scan": digest}, parameters={}, seconds=4) as stage:
            write_ply(stage / "mesh.ply", box(0.07))
        digest = session.record("reconstruction").digest
        with session.writing("collision", inputs={"reconstruction": digest}, parameters={}):
            pass
        make_session.imagine(session, kept=10)
    make_session.judge(mug, (1, 1))
    make_session.pour(bowl, spilled=3)
    found = rows(mug, bowl)
    assert said(found["Object", "from"]) == (
        "scan of mug, simulated cell",
        "scan of bowl, simulated cell",
        "",
    )
    assert said(found["Object", "size (x, y, z)"]) == (
        "100 x 80 x 50 mm",
        "100 x 80 x 70 mm",
        "+0, +0, +20 mm",
    )
    assert said(found["Object", "volume of the material"]) == ("400 ml", "560 ml", "+160 ml")
    assert said(found["Imagination", "Omega"]) == ("0.400", "0.100", "-0.300")
    assert found["Imagination", "verdict"].is_same
    assert said(found["Pour", "best P"]) == ("100 %", "100 %", "")
    assert said(found["Pour", "P of the chosen pour"]) == ("75 %", "100 %", "+25 %")
    assert said(found["Pour", "chosen pour"]) == ("from 180°, 20 mm out", "from 0°, 20 mm out", "")
    assert found["Pour", "chosen by"].a == "the program"
    assert said(found["Pour", "pours that the arm can make"]) == ("5 of 6", UNKNOWN, "")
    assert said(found["Pour", "outcome"]) == (UNKNOWN, "3 of 60 candies were spilled.", "")
    assert said(found["Time", "reconstruction"]) == ("1.5 s", "4.0 s", "+2.5 s")
    assert said(found["Time", "motion"]) == ("1.5 s", UNKNOWN, "")
    assert said(found["Parameters", "pouring.n_pour"]) == ("60", "40", "-20")


def test_who_chose_the_pour(make_session, rows):
    a, b = make_session("a"), make_session("b", kept=0)
    write_operator_choice(a, 1, 0, "the handle", Session.open(a).record("pouring").digest)
    found = rows(a, b)
    assert said(found["Pour", "chosen by"]) == ("the operator: the handle", UNKNOWN, "")
    assert said(found["Pour", "P of the chosen pour"]) == ("25 %", UNKNOWN, "")


def test_lengths_of_parameters_are_in_millimetres(make_session, rows):
    a = make_session("a", **{"reconstruction.truncation_m": None})
    b = make_session("b", **{"reconstruction.truncation_m": 0.012, "particle.diameter_m": 0.009})
    found = rows(a, b)
    assert said(found["Parameters", "particle.diameter_m"]) == ("13.2 mm", "9 mm", "-4.2 mm")
    assert said(found["Parameters", "reconstruction.truncation_m"]) == ("automatic", "12 mm", "")


def test_a_difference_is_that_of_the_numbers_as_shown(make_session, rows):
    a, b = make_session("a"), make_session("b")
    for folder, seconds in ((a, 1.04), (b, 2.16)):
        record = folder / "scan" / "record.json"
        record.write_text(json.dumps(json.loads(record.read_text()) | {"seconds": seconds}))
    assert said(rows(a, b)["Time", "scan"]) == ("1.0 s", "2.2 s", "+1.2 s")


def test_sessions_that_hold_little(make_session, rows):
    found = rows(make_session.empty("new"), make_session.of_mesh("pot", "teapot.ply"))
    assert said(found["Object", "size (x, y, z)"]) == (UNKNOWN, "100 x 80 x 50 mm", "")
    assert said(found["Imagination", "Omega"]) == (UNKNOWN, UNKNOWN, "")
    assert said(found["Parameters", "preset"]) == ("not recorded", "not recorded", "")


def test_a_session_that_cannot_be_read_is_a_sentence(make_session, tmp_path):
    folder = make_session("mug")
    with pytest.raises(SessionError, match="There is no session"):
        compare(folder, tmp_path / "nowhere")
    (folder / PARAMETERS_FILE).write_text('{"parameters": {"no.such": 1}}')
    with pytest.raises(PoursightError, match="no parameter"):
        compare(folder, folder)
