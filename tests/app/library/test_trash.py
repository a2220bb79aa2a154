import importlib

import pytest

from app.library.index import send_to_trash
from core.errors import SessionError
from core.session import Session


@pytest.fixture
def trash(tmp_path, monkeypatch):
    """A trash of its own, by the freedesktop.org specification."""
    monkeypatch.setenv("HOME", str(tmp_path))
    monkeypatch.setenv("XDG_DATA_HOME", str(tmp_path / "data"))
    from send2trash import plat_other

    importlib.reload(plat_other)
    monkeypatch.setattr("send2trash.send2trash", plat_other.send2trash)
    yield tmp_path / "data" / "Trash"
    monkeypatch.undo()
    importlib.reload(plat_other)


def test_a_session_goes_to_the_trash_whole(make_session, trash):
    folder = make_session("mug")
    files = {path.relative_to(folder) for path in folder.rglob("*") if path.is_file()}
    send_to_trash(folder)
    assert not folder.exists()
    assert files <= {
        path.relative_to(trash / "files" / "mug") for path in (trash / "files" / "mug").rglob("*")
    }
    assert str(folder) in (trash / "info" / "mug.trashinfo").read_text()
    (trash / "files" / "mug").rename(folder)  # what a file manager does to bring it back
    with Session.open(folder) as session:
        assert session.record("pouring") is not None


def test_two_of_one_name(make_session, trash):
    for _ in range(2):
        send_to_trash(make_session("mug"))
    assert len(list((trash / "files").iterdir())) == 2


def test_a_session_that_is_open_stays(make_session, trash):
    folder = make_session("mug")
    with Session.open(folder), pytest.raises(SessionError, match="close it first"):
        send_to_trash(folder)
    assert Session.open(folder).record("pouring") is not None
    assert not trash.exists()
    send_to_trash(folder)
    assert not folder.exists()


def test_a_damaged_session_can_be_deleted(make_session, trash):
    folder = make_session("mug")
    (folder / "session.json").write_text("nonsense")
    send_to_trash(folder)
    assert not folder.exists()


def test_only_sessions_are_deleted(tmp_path, trash):
    (tmp_path / "thesis").mkdir()
    with pytest.raises(SessionError, match="is no session"):
        send_to_trash(tmp_path / "thesis")
    assert (tmp_path / "thesis").is_dir()


def test_without_a_trash_nothing_is_deleted(make_session, tmp_path, trash):
    folder = make_session("mug")
    (tmp_path / "data").write_text("a file where the trash should be")
    with pytest.raises(SessionError, match="nothing was deleted"):
        send_to_trash(folder)
    assert Session.open(folder).record("pouring") is not None
    with Session.open(folder):
        pass  # and it is not locked any more


def test_a_trash_that_says_nothing(make_session, monkeypatch):
    from send2trash import TrashPermissionError

    def refuse(_):
        raise TrashPermissionError("")

    monkeypatch.setattr("send2trash.send2trash", refuse)
    folder = make_session("mug")
    with pytest.raises(SessionError, match="cannot be moved to the trash"):
        send_to_trash(folder)
    assert folder.is_dir()
