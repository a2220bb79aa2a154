"""What a person chose is kept whole, holds for one imagination, and is never passed over in silence."""

import json
from pathlib import Path

import pytest

from core.errors import InputError, SessionError
from core.session.operator_choice import (
    CHOICE_FILE,
    OperatorChoice,
    read_operator_choice,
    withdraw_operator_choice,
    write_operator_choice,
)

IMAGINED, OTHER = "a" * 64, "b" * 64


def test_a_choice_is_read_as_it_was_written(tmp_path: Path) -> None:
    made = write_operator_choice(tmp_path, 3, 1, "  the handle is\n in the way ", IMAGINED)
    assert (made.i, made.j, made.reason) == (3, 1, "the handle is in the way")
    assert made.time.endswith("+00:00")
    assert read_operator_choice(tmp_path, IMAGINED) == made
    assert [path.name for path in tmp_path.iterdir()] == [CHOICE_FILE]


def test_it_holds_for_the_imagination_it_was_made_for(tmp_path: Path) -> None:
    write_operator_choice(tmp_path, 3, 1, "handle", IMAGINED)
    assert read_operator_choice(tmp_path, OTHER) is None
    assert read_operator_choice(tmp_path, IMAGINED) is not None


def test_a_second_choice_replaces_the_first_and_can_be_withdrawn(tmp_path: Path) -> None:
    assert read_operator_choice(tmp_path, IMAGINED) is None
    withdraw_operator_choice(tmp_path)
    write_operator_choice(tmp_path, 3, 1, "handle", IMAGINED)
    second = write_operator_choice(tmp_path, 0, 0, "nearer to me", IMAGINED)
    assert read_operator_choice(tmp_path, IMAGINED) == second
    withdraw_operator_choice(tmp_path)
    assert read_operator_choice(tmp_path, IMAGINED) is None


@pytest.mark.parametrize("reason", ["", "  \n "])
def test_a_choice_without_a_reason_is_refused(tmp_path: Path, reason: str) -> None:
    write_operator_choice(tmp_path, 3, 1, "handle", IMAGINED)
    with pytest.raises(InputError, match="needs a reason"):
        write_operator_choice(tmp_path, 0, 0, reason, IMAGINED)
    kept = read_operator_choice(tmp_path, IMAGINED)
    assert isinstance(kept, OperatorChoice) and kept.reason == "handle"


WHOLE = {"i": 1, "j": 2, "reason": "x", "imagination": IMAGINED, "time": "2026-11-21T10:00:00+00:00"}


@pytest.mark.parametrize(
    "text",
    [
        "",
        "{",
        "[]",
        "{}",
        json.dumps(WHOLE | {"i": "1"}),
        json.dumps(WHOLE | {"j": 1.5}),
        json.dumps(WHOLE | {"reason": None}),
        json.dumps(WHOLE | {"surprise": 1}),
    ],
)
def test_a_damaged_choice_is_told_and_can_be_withdrawn(tmp_path: Path, text: str) -> None:
    (tmp_path / CHOICE_FILE).write_text(text)
    with pytest.raises(SessionError, match="is damaged; choose again, or withdraw"):
        read_operator_choice(tmp_path, IMAGINED)
    withdraw_operator_choice(tmp_path)
    assert read_operator_choice(tmp_path, IMAGINED) is None
