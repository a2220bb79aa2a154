"""A library of its own with two sessions, and the page that shows it."""

import importlib
import shutil

import pytest


@pytest.fixture
def root(tmp_path, monkeypatch):
    """The folder that holds the sessions."""
    folder = tmp_path / "sessions"
    folder.mkdir()
    monkeypatch.setenv("POURSIGHT_SESSIONS", str(folder))
    return folder


@pytest.fixture
def library(root, mug_session, block_session):
    """A mug and, made later, a block."""
    for session in (mug_session, block_session):
        shutil.move(session, root / session.name)
    _date(root / "mug", "2026-11-19T08:00:00+00:00")
    _date(root / "block", "2026-11-20T08:00:00+00:00")
    return root


def _date(folder, created):
    from core.files import read_json, write_json

    table = read_json(folder / "session.json")
    write_json(folder / "session.json", table | {"created": created})


@pytest.fixture
def make_page(desk, qtbot):
    """Makes the page and waits until it has looked for sessions."""
    from app.gui.pages.history.page import HistoryPage

    def make():
        page = HistoryPage(desk)
        qtbot.addWidget(page)
        page.resize(1060, 640)
        page.show()
        qtbot.waitUntil(lambda: page._list.shown != "loading")
        return page

    return make


@pytest.fixture
def trash(tmp_path, monkeypatch):
    """A trash of its own."""
    monkeypatch.setenv("HOME", str(tmp_path))
    monkeypatch.setenv("XDG_DATA_HOME", str(tmp_path / "data"))
    from send2trash import plat_other

    importlib.reload(plat_other)
    monkeypatch.setattr("send2trash.send2trash", plat_other.send2trash)
    yield tmp_path / "data" / "Trash" / "files"
    monkeypatch.undo()
    importlib.reload(plat_other)
