"""Each picture is reported once, as soon as it is there, and all else is passed on."""

from __future__ import annotations

import pytest

from app.jobs.messages import Event, Progressed, Warned
from app.jobs.service import JobReporter
from app.jobs.session_work import PictureDrawn, PictureReporter
from core.errors import Cancelled


@pytest.fixture
def heard():
    return []


@pytest.fixture
def reporter(heard):
    return JobReporter(heard.append)


def test_each_picture_is_reported_once(reporter, heard, tmp_path):
    pictures = PictureReporter(reporter, tmp_path / "session", tmp_path)
    for name in ("b.png", "a.png", ".c.png.part", "film.mp4"):
        (tmp_path / name).write_bytes(b"")
    pictures.progress("evidence", 1, 2)
    (tmp_path / "d.png").write_bytes(b"")
    pictures.progress("evidence", 2, 2)
    published = [message.payload for message in heard if isinstance(message, Event)]
    assert published == [
        PictureDrawn(tmp_path / "session", tmp_path / name) for name in ("a.png", "b.png", "d.png")
    ]


def test_progress_warnings_and_cancel_go_through(reporter, heard, tmp_path):
    pictures = PictureReporter(reporter, tmp_path, tmp_path)
    pictures.progress("evidence", 1, 2)
    pictures.warn("Slowly.")
    assert heard == [Progressed("evidence", 1, 2), Warned("Slowly.")]
    pictures.raise_if_cancelled()
    reporter.cancel()
    with pytest.raises(Cancelled):
        pictures.raise_if_cancelled()
