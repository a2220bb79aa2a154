import time
from pathlib import Path

from app.library.session_folder import UNFINISHED_SCAN
from app.library.summary import PourScore, summarize
from core.session import Session
from core.session.operator_choice import write_operator_choice
from tests.awake import in_time


def test_a_poured_session_tells_everything(make_session):
    folder = make_session("mug")
    make_session.judge(folder, (1, 2))
    make_session.render(folder)
    make_session.pour(folder, spilled=4)
    make_session.pour(folder, done=False)
    summary = summarize(folder)
    assert summary.problem == ""
    assert (summary.name, summary.source, summary.n_views) == ("mug", "scan of mug, simulated cell", 3)
    assert (summary.is_open_container, summary.omega, summary.omega_threshold) == (True, 0.4, 0.0)
    assert summary.chosen == PourScore(1, 2, 1.0)
    assert (summary.n_runs, summary.n_spilled) == (2, 4)
    assert summary.outcome == "4 of 60 candies were spilled."
    assert summary.stages[0] == "scan" and summary.stages[-1] == "evidence"
    assert summary.verdict_words == "open container"
    files = [path for path in folder.rglob("*") if path.is_file() and not path.name.startswith(".")]
    assert summary.size_bytes == sum(path.stat().st_size for path in files)


def test_among_equals_the_chosen_pour_is_the_best(make_session):
    folder = make_session("mug")
    assert summarize(folder).best == PourScore(0, 1, 1.0)
    make_session.judge(folder, (1, 2))
    assert summarize(folder).best == PourScore(1, 2, 1.0)
    make_session.judge(folder, (1, 1))
    assert summarize(folder).chosen == PourScore(1, 1, 0.75)
    assert summarize(folder).best == PourScore(0, 1, 1.0)


def test_what_the_operator_chose_stands_above_the_arms_choice(make_session):
    folder = make_session("mug")
    make_session.judge(folder, (1, 2))
    digest = Session.open(folder).record("pouring").digest
    write_operator_choice(folder, 1, 0, "the handle is in the way", digest)
    summary = summarize(folder)
    assert (summary.chosen, summary.operator_reason) == (PourScore(1, 0, 0.25), "the handle is in the way")
    write_operator_choice(folder, 1, 0, "it was about other pours", "0" * 64)
    assert (summarize(folder).chosen, summarize(folder).operator_reason) == (PourScore(1, 2, 1.0), "")
    write_operator_choice(folder, 7, 0, "there is no such pour", digest)
    assert summarize(folder).problem.endswith(".")


def test_no_container_has_no_pour(make_session):
    summary = summarize(make_session("block", kept=0))
    assert (summary.is_open_container, summary.best, summary.chosen) == (False, None, None)
    assert summary.verdict_words == "not a container"


def test_what_was_made_from_an_older_stage_does_not_count(make_session):
    folder = make_session("mug")
    make_session.judge(folder, (1, 2))
    with Session.open(folder) as session:
        make_session.imagine(session, kept=30)
    summary = summarize(folder)
    assert summary.omega == 0.3
    assert summary.chosen == PourScore(0, 1, 1.0)  # the arm's choice belonged to the pours of before
    assert "motion" not in summary.stages
    with Session.open(folder) as session, session.writing("scan", inputs={}, parameters={}) as stage:
        (stage / "new").write_text("another scan")
    summary = summarize(folder)
    assert (summary.is_open_container, summary.best, summary.stages) == (None, None, ("scan",))


def test_pours_of_before_the_verdict_do_not_count(make_session):
    folder = make_session("mug")
    with Session.open(folder) as session:
        make_session.drop(session, kept=0)
    summary = summarize(folder)
    assert (summary.is_open_container, summary.best, summary.chosen) == (False, None, None)


def test_a_run_without_an_outcome_says_how_it_ended(make_session):
    folder = make_session("mug")
    make_session.pour(folder, done=False)
    assert summarize(folder).outcome == "Stopped before the first move: The robot stopped."
    make_session.pour(folder, back_off=True)
    assert summarize(folder).n_runs == 1


def test_where_the_object_is_from(make_session):
    assert summarize(make_session.of_mesh("pot", "teapot.ply")).source == "mesh teapot.ply"
    folder = make_session.empty("imported")
    with (
        Session.open(folder) as session,
        session.writing("scan", inputs={}, parameters={"source": "/scans/blue tray"}),
    ):
        pass
    assert summarize(folder).source == "imported scan blue tray"
    folder = make_session.empty("new")
    assert summarize(folder).source == ""
    (folder / UNFINISHED_SCAN).mkdir()
    assert summarize(folder).source == "unfinished scan"


def test_the_unfinished_scan_is_where_the_scan_puts_it():
    from app.library.session_folder import UNFINISHED_SCAN

    assert UNFINISHED_SCAN == UNFINISHED_SCAN


def test_damage_is_a_sentence(make_session, tmp_path):
    folder = make_session("mug")
    pours = folder / "pouring" / "pours.json"
    for damage in ("", "[]", '{"p": 3}', '{"p": [[0.5]]}', '{"p": {}}'):
        pours.write_text(damage)
        summary = summarize(folder)
        assert summary.problem.endswith(".") and "mug" in summary.problem, damage
        assert summary.name == "mug" and summary.created
    (folder / "session.json").write_text("nonsense")
    assert "session.json is damaged" in summarize(folder).problem
    assert "There is no session" in summarize(tmp_path / "nowhere").problem


def test_a_damaged_run_is_a_sentence(make_session):
    folder = make_session("mug")
    run = make_session.pour(folder, spilled=1)
    (run / "outcome.json").write_text('{"n_candies": 60}')
    assert summarize(folder).problem.endswith(".")


def test_it_takes_less_than_5_ms_of_a_processor(make_session):
    folder = make_session("mug")
    make_session.judge(folder, (1, 2))
    make_session.pour(folder, spilled=4)
    times_s = []
    for _ in range(20):
        started = time.process_time()
        summarize(folder)
        times_s.append(time.process_time() - started)
    in_time(min(times_s), 0.005)


def test_a_relative_path_is_made_absolute(make_session, monkeypatch):
    folder = make_session("mug")
    monkeypatch.chdir(folder.parent)
    assert summarize(Path("mug")).path == folder
