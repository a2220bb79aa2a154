"""The command line, run where no test does: what makes the sessions to be copied."""

from __future__ import annotations

import sys

import pytest

from app import cli
from tests.app.quick_cell import quick_cell


def command(*words: object) -> None:
    """Run a command with the simulated cell of few views; it must not fail."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("app.cli.session_commands.read_cell", quick_cell)
        patch.setattr(sys, "argv", ["poursight", *map(str, words)])
        with pytest.raises(SystemExit) as leaving:
            cli.main()
        assert not leaving.value.code
