"""What a page reads in the background, when it reads again, and what it drops."""

from __future__ import annotations

from threading import Event

import pytest

from app.gui.pages.background_page import BackgroundPage
from core.errors import SessionError


class NotesPage(BackgroundPage[str, str]):
    KEY = "notes"

    def __init__(self, desk):
        self.read_keys, self.shown, self.gate = [], [], Event()
        self.gate.set()
        self.key = None
        self.n_updates = 0
        super().__init__(desk, self.read_note)

    def read_note(self, key):
        self.read_keys.append(key)
        assert self.gate.wait(10)
        if key == "damaged":
            raise SessionError("The note is damaged; write it again.")
        return f"note {key}"

    def content_key(self):
        return self.key

    def show_content(self, former):
        self.shown.append((former, self.content, self.failure))

    def update_actions(self):
        self.n_updates += 1


@pytest.fixture
def page(qtbot, desk):
    page = NotesPage(desk)
    qtbot.addWidget(page)
    return page


@pytest.fixture
def show(qtbot, desk, page):
    def show(key):
        page.key = key
        page.refresh()
        qtbot.waitUntil(lambda: desk.background.is_idle)

    return show


def test_content_is_read_once_for_each_key(page, show):
    show("a")
    show("a")
    show("b")
    assert page.read_keys == ["a", "b"]
    assert page.shown == [(None, "note a", ""), ("note a", "note b", "")]
    assert page.n_updates == 3


def test_a_failure_is_shown_and_forgotten_with_the_next_content(page, show):
    show("a")
    show("damaged")
    show("b")
    assert page.shown[1:] == [
        ("note a", None, "The note is damaged; write it again."),
        (None, "note b", ""),
    ]


def test_without_a_key_nothing_is_shown(page, show):
    show("a")
    show(None)
    assert page.content is None
    assert page.shown[-1] == ("note a", None, "")
    show("a")
    assert page.read_keys == ["a", "a"]


def test_what_arrives_too_late_is_dropped(page, show):
    page.gate.clear()
    page.key = "a"
    page.refresh()
    page.key = None
    page.refresh()
    page.gate.set()
    show(None)
    assert page.shown == []


def test_another_session_shows_nothing_of_the_last_one(page, show, desk, tmp_path):
    desk.workspace.open(tmp_path / "one")
    show("a")
    page.gate.clear()
    desk.workspace.open(tmp_path / "two")
    page.key = "b"
    page.refresh()
    assert page.content is None
    page.gate.set()
    show("b")
    assert page.shown[-1] == (None, "note b", "")


def test_parts_are_read_apart_and_tell_their_errors(page, show, desk, qtbot):
    parts = []
    page.load("part", 1, lambda key: key + 1, parts.append)
    page.load("part", 1, lambda key: key + 1, parts.append)
    with qtbot.waitSignal(desk.message) as told:
        page.load("other", "damaged", page.read_note, parts.append)
    qtbot.waitUntil(lambda: desk.background.is_idle)
    assert parts == [2]
    assert told.args == ["The note is damaged; write it again."]
