"""Progress on the terminal."""

import io

from rich.console import Console

from app.cli.terminal import TerminalReporter

PER_CENT = (0, 50, 100, 100)


def test_a_stage_that_is_over_says_so_once(capsys):
    with TerminalReporter() as terminal:
        for done in PER_CENT:
            terminal.progress("pour", done, 100)
    assert capsys.readouterr().err.splitlines() == ["pour: 0 %", "pour: 100 %"]


def test_a_stage_that_begins_once_more_shows_its_progress_again(capsys):
    with TerminalReporter() as terminal:
        for done in (*PER_CENT, 3, 50, 100):
            terminal.progress("pour", done, 100)
    lines = [line.split(",")[0] for line in capsys.readouterr().err.splitlines()]
    assert lines == ["pour: 0 %", "pour: 100 %", "pour: 3 %", "pour: 100 %"]


def test_its_bar_and_its_clock_begin_once_more_too(monkeypatch):
    screen = Console(file=io.StringIO(), force_terminal=True)
    monkeypatch.setattr("app.cli.terminal.Console", lambda **_: screen)
    with TerminalReporter() as terminal:
        for done in PER_CENT:
            terminal.progress("pour", done, 100)
        (bar,) = terminal._progress.tasks
        assert bar.finished
        terminal.progress("pour", 40, 100)
        assert (bar.finished, bar.percentage) == (False, 40)
        assert bar.finished_time is None
