"""The benchmark that kills the window: its scripts run in other processes, where nobody sees them fail."""

from __future__ import annotations

import ast
import importlib

import pytest

from tests.benchmarks.window_kills import LOOK, TOUR, kill_once

LONG_S = 600.0


@pytest.mark.parametrize("script", [TOUR, LOOK], ids=["tour", "look"])
def test_what_its_scripts_import_exists(script):
    imports = [node for node in ast.walk(ast.parse(script)) if isinstance(node, ast.ImportFrom)]
    assert imports
    for node in imports:
        module = importlib.import_module(node.module)
        assert [name.name for name in node.names if not hasattr(module, name.name)] == []


def test_a_program_that_ends_before_it_is_killed_is_told(tmp_path):
    tried = kill_once(tmp_path, LONG_S, "raise SystemExit('a fault of its own')")
    assert not tried.in_time
    assert tried.problems == "it ended by itself: a fault of its own"
    assert tried.found == "before a session"
