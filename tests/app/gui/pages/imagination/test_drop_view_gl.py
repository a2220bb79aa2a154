"""The replay as it is really drawn. Run with -m gl under xvfb-run."""

from __future__ import annotations

import statistics
import time

import numpy as np
import pytest
from PySide6.QtGui import QImage

from app.gui.pages.imagination.drop import key_of, load
from app.gui.pages.imagination.view import DropReplay
from core.imagination.recording import Recording
from core.imagination.results import Drop
from core.pipeline.session_view import SessionView
from tests.awake import in_time

pytestmark = pytest.mark.gl
N = 300


def with_candies(folder, n):
    """The session's drop, its candies repeated until there are so many."""
    path = folder / "containability"
    found = Drop.load(path)
    take = np.arange(n) % found.n_drop
    recording = found.recording
    many = Recording(
        recording.time_s,
        recording.positions_m[:, take],
        recording.quaternions[:, take],
        recording.T_world_body,
    )
    drops = found.drop_positions_m[take]
    Drop(drops, found.retained[take], found.aabb_m, found.footprint, many).save(path)
    return load(key_of(SessionView.of(folder)))


@pytest.fixture
def replay(qtbot, mug_session):
    replay = DropReplay()
    replay.resize(660, 500)
    qtbot.addWidget(replay)
    with qtbot.waitExposed(replay):
        replay.show()
    replay.show_drop(with_candies(mug_session, N))
    return replay


def n_like(image: QImage, color, gap=70):
    rgb = image.convertToFormat(QImage.Format.Format_RGBX8888)
    pixels = np.frombuffer(rgb.constBits(), dtype=np.uint8).reshape(rgb.height(), -1, 4)[:, :, :3].astype(int)
    wanted = [int(color[k : k + 2], 16) for k in (1, 3, 5)]
    return int((np.abs(pixels - wanted).max(axis=-1) < gap).sum())


def test_three_hundred_candies_are_moved_in_less_than_five_milliseconds(replay):
    spent_s = []
    for time_s in np.linspace(0, replay.timeline.duration_s, 100):
        began_s = time.thread_time()
        replay._show_time(float(time_s))
        spent_s.append(time.thread_time() - began_s)
    print(f"per frame {1000 * statistics.median(spent_s):.2f} ms, worst {1000 * max(spent_s):.2f} ms")
    in_time(statistics.median(spent_s), 0.005)


def test_kept_and_lost_candies_are_seen_at_any_time(replay):
    from app.gui.theme import LIGHT, theme_of

    assert theme_of(replay) is LIGHT
    for time_s in (0.05, replay.timeline.duration_s):
        replay.timeline.set_time(time_s)
        image = replay.scene.grab_image()
        assert n_like(image, LIGHT.kept) > 100
        assert n_like(image, LIGHT.lost) > 100


def test_walls_hide_the_candies_unless_one_sees_through_them(replay, qtbot):
    from app.gui.theme import LIGHT

    replay.scene.look_from("front")
    through = n_like(replay.scene.grab_image(), LIGHT.kept)
    replay._see_through.click()
    hidden = n_like(replay.scene.grab_image(), LIGHT.kept)
    assert hidden < 0.2 * through
