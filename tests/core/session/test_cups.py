"""Which cup was poured, and which comes next."""

import json
from pathlib import Path

from core.session.cups import Cup, cup_of_run, next_cup
from core.session.pour_runs import EVENTS_FILE, next_run_folder, note_emptied

CUPS = (50, 50, 40)


def make_run(
    session: Path, imagination: str = "now", *, is_done: bool = True, is_back_off: bool = False
) -> Path:
    folder = next_run_folder(session)
    folder.mkdir(parents=True)
    events = [{"kind": "confirmed", "imagination": imagination, "is_back_off": is_back_off}]
    events += [{"kind": "done"}] if is_done else [{"kind": "stopped", "sentence": "It was stopped."}]
    (folder / EVENTS_FILE).write_text("".join(json.dumps(event) + "\n" for event in events))
    return folder


def test_one_cup_is_always_the_first_and_into_an_empty_object(tmp_path: Path) -> None:
    assert next_cup(tmp_path, "now", (60,)) == Cup(1, 1, 60, None)
    make_run(tmp_path)
    assert next_cup(tmp_path, "now", (60,)) == Cup(1, 1, 60, None)
    assert next_cup(tmp_path, "now", (60,)).words == ""


def test_cups_follow_each_other_and_begin_anew_after_the_last(tmp_path: Path) -> None:
    runs = []
    for number, n_candies in enumerate(CUPS, 1):
        before = runs[-1] if runs else None
        assert next_cup(tmp_path, "now", CUPS) == Cup(number, 3, n_candies, before)
        runs.append(make_run(tmp_path))
        assert cup_of_run(tmp_path, runs[-1], CUPS) == Cup(number, 3, n_candies, before)
    assert next_cup(tmp_path, "now", CUPS) == Cup(1, 3, 50, None)
    assert cup_of_run(tmp_path, runs[1], CUPS).words == "cup 2 of 3, 50 candies in it"


def test_what_was_stopped_or_poured_by_another_imagination_is_no_cup(tmp_path: Path) -> None:
    first = make_run(tmp_path)
    make_run(tmp_path, "another")
    make_run(tmp_path, is_done=False)
    make_run(tmp_path, is_back_off=True)
    assert next_cup(tmp_path, "now", CUPS) == Cup(2, 3, 50, first)


def test_into_an_object_that_was_emptied_the_first_cup_comes_again(tmp_path: Path) -> None:
    note_emptied(tmp_path)  # nothing was poured yet
    before = make_run(tmp_path)
    make_run(tmp_path, is_done=False)
    note_emptied(tmp_path)
    assert next_cup(tmp_path, "now", CUPS) == Cup(1, 3, 50, None)
    first = make_run(tmp_path)
    assert next_cup(tmp_path, "now", CUPS) == Cup(2, 3, 50, first)
    second = make_run(tmp_path)
    assert [cup_of_run(tmp_path, run, CUPS).number for run in (before, first, second)] == [1, 1, 2]
