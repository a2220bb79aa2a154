import pytest

from app.cli import session_commands
from app.library.places import SESSIONS_VARIABLE
from core.errors import SessionError


@pytest.fixture(autouse=True)
def here(library_root, monkeypatch):
    monkeypatch.setenv(SESSIONS_VARIABLE, str(library_root))


def test_sessions_are_listed_one_a_line(make_session, capsys):
    mug = make_session("mug [bold] :+1:")
    make_session.pour(mug, spilled=2)
    block = make_session("block", kept=0)
    (make_session.empty("broken") / "session.json").write_text("nonsense")
    session_commands.sessions("")
    out, err = capsys.readouterr()
    header, *lines = out.splitlines()
    assert header.split() == ["created", "name", "from", "verdict", "P", "outcome", "MB", "folder"]
    assert len(lines) == 3 and err == ""
    line = next(line for line in lines if str(mug) in line)
    for word in ("mug [bold] :+1:", "open container", "100 %", "2 spilled"):
        assert word in line
    assert "not a container" in next(line for line in lines if str(block) in line)
    assert "is damaged" in next(line for line in lines if "broken" in line)


def test_sessions_are_searched(make_session, capsys):
    make_session("mug")
    make_session("block", kept=0)
    session_commands.sessions("OPEN container")
    out, _ = capsys.readouterr()
    assert "mug" in out and "block" not in out
    session_commands.sessions("teapot")
    out, err = capsys.readouterr()
    assert out == "" and "teapot" in err and str(make_session.root) in err


def test_export_names_what_it_wrote(make_session, tmp_path, capsys):
    folder = make_session("mug")
    make_session.report(folder)
    files = [tmp_path / name for name in ("a.html", "a.pdf", "a.zip")]
    session_commands.export(folder, *files, overwrite=False, workers=1)
    out, _ = capsys.readouterr()
    assert out == "".join(f"Exported: {file}\n" for file in files)
    assert all(file.stat().st_size > 50 for file in files)


def test_an_old_report_is_written_anew_first(make_session, tmp_path, monkeypatch, capsys):
    folder = make_session("mug")
    written = []

    def report(pipeline):
        written.append(pipeline.session.path)
        return make_session.report(folder)

    monkeypatch.setattr("core.pipeline.pipeline.Pipeline.report", report)
    session_commands.export(folder, None, None, tmp_path / "a.zip", overwrite=False, workers=2)
    assert written == []
    session_commands.export(folder, tmp_path / "a.html", None, None, overwrite=False, workers=2)
    session_commands.export(folder, tmp_path / "b.html", None, None, overwrite=False, workers=2)
    assert written == [folder]
    assert f"Report: {folder / 'report.html'}" in capsys.readouterr().out


def test_no_session_is_a_sentence(tmp_path):
    with pytest.raises(SessionError, match="There is no session"):
        session_commands.export(tmp_path / "x", tmp_path / "a", None, None, overwrite=False, workers=1)
