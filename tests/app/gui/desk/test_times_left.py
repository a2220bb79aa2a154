"""How long a motion will still take: its panel and the job bar tell it side by side."""

from types import SimpleNamespace

import pytest

from app.gui.desk.jobs import RunningJob
from app.jobs import connected_arm
from app.jobs.connected_arm import MoveReporter
from app.jobs.messages import Progressed

TOTAL_S = 20.0


class Job:
    """Keeps what is published; the window's job gets the progress."""

    def __init__(self):
        self.in_window = RunningJob("Pour", "robot", "", None, None)
        self.published = []

    def progress(self, stage, done, total):
        self.in_window.progress(Progressed(stage, done, total))

    def publish(self, news):
        self.published.append(news)


@pytest.fixture
def clock(monkeypatch):
    clock = SimpleNamespace(now_s=100.0)
    monkeypatch.setattr("time.monotonic", lambda: clock.now_s)
    return clock


def test_what_comes_before_the_first_move_says_nothing_of_its_pace(clock):
    job, moves = Job(), MoveReporter()
    both_s = TOTAL_S / 2
    planned = [SimpleNamespace(name=name, trajectory=SimpleNamespace(duration_s=both_s)) for name in "ab"]
    moves.begin(job, planned, lambda _: None)
    clock.now_s += 6.0  # the plan is checked once more
    for done_s in range(16):
        moves.progress("pour", done_s, TOTAL_S)
        clock.now_s += 0.25  # four times as fast as planned
    newest = job.published[-1]
    assert (newest.index, newest.name, newest.fraction) == (1, "b", pytest.approx(0.5))
    assert newest.left_s == pytest.approx(5.0 / 4)
    clock.now_s -= 0.25
    assert newest.left_s == pytest.approx(job.in_window.seconds_left), "what the job bar tells beside it"


def test_before_a_second_is_over_it_is_what_was_planned(clock):
    job, moves = Job(), MoveReporter()
    moves.begin(
        job, [SimpleNamespace(name="a", trajectory=SimpleNamespace(duration_s=TOTAL_S))], lambda _: None
    )
    moves.progress("pour", 0.0, TOTAL_S)
    clock.now_s += 2 * connected_arm._MIN_INTERVAL_S
    moves.progress("pour", 1.0, TOTAL_S)
    assert [news.left_s for news in job.published] == [TOTAL_S, TOTAL_S - 1]
