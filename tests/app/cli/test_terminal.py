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


def test_a_stage_that_begins_once_more_after_another_shows_its_progress_again(capsys):
    with TerminalReporter() as terminal:
        for stage in ("pour", "outcome", "pour"):
            for done in (3, 50, 100):
                terminal.progress(stage, done, 100)
    lines = [line.split(",")[0] for line in capsys.readouterr().err.splitlines()]
    pour = ["pour: 3 %", "pour: 100 %"]
    assert lines == [*pour, "outcome: 3 %", "outcome: 100 %", *pour]


def test_a_stage_of_several_parts_is_over_once(capsys):
    with TerminalReporter() as terminal:
        for done in (*PER_CENT, *PER_CENT):
            terminal.progress("capacity", done, 100)
    assert capsys.readouterr().err.splitlines() == ["capacity: 0 %", "capacity: 100 %"]


def test_its_bar_and_its_clock_begin_once_more_too(monkeypatch):
    screen = Console(file=io.StringIO(), force_terminal=True)
    monkeypatch.setattr("app.cli.terminal.Console", lambda **_: screen)
    with TerminalReporter() as terminal:
        for done in PER_CENT:
            terminal.progress("pour", done, 100)
        bar = terminal._progress.tasks[0]
        assert bar.finished
        terminal.progress("outcome", 0, 100)
        terminal.progress("pour", 40, 100)
        assert (bar.finished, bar.percentage) == (False, 40)
        assert bar.finished_time is None
