"""Each picture is told once, as soon as it is there, and all else is passed on."""

from __future__ import annotations

import pytest

from app.jobs.face import JobFace
from app.jobs.messages import News, Progressed, Warned
from app.jobs.render_news import PictureDrawn, PictureWatch
from core.errors import Cancelled


@pytest.fixture
def heard():
    return []


@pytest.fixture
def face(heard):
    return JobFace(heard.append)


def test_each_picture_is_told_once(face, heard, tmp_path):
    watch = PictureWatch(face, tmp_path / "session", tmp_path)
    for name in ("b.png", "a.png", ".c.png.part", "film.mp4"):
        (tmp_path / name).write_bytes(b"")
    watch.progress("evidence", 1, 2)
    (tmp_path / "d.png").write_bytes(b"")
    watch.progress("evidence", 2, 2)
    told = [message.payload for message in heard if isinstance(message, News)]
    assert told == [
        PictureDrawn(tmp_path / "session", tmp_path / name) for name in ("a.png", "b.png", "d.png")
    ]


def test_progress_warnings_and_cancel_go_through(face, heard, tmp_path):
    watch = PictureWatch(face, tmp_path, tmp_path)
    watch.progress("evidence", 1, 2)
    watch.warn("Slowly.")
    assert heard == [Progressed("evidence", 1, 2), Warned("Slowly.")]
    watch.raise_if_cancelled()
    face.cancel()
    with pytest.raises(Cancelled):
        watch.raise_if_cancelled()
