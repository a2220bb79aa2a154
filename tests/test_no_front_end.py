"""Sentences of core and hardware name no command, no flag and no button: front ends word the remedies."""

import ast
import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
FRONT_END = re.compile(
    r"(?<![\w-])--[a-z]{3,}|[Ss]ame command|[Tt]he command again|'poursight |\b[Pp]ress [A-Z]"
)


def sentences_raised(tree):
    """Yield the texts in every `raise` and `warn`."""
    for node in ast.walk(tree):
        is_warning = isinstance(node, ast.Call) and getattr(node.func, "attr", "") == "warn"
        if isinstance(node, ast.Raise) or is_warning:
            for part in ast.walk(node):
                if isinstance(part, ast.Constant) and isinstance(part.value, str):
                    yield part.value


@pytest.mark.parametrize("floor", ["core", "hardware"])
def test_no_error_or_warning_names_a_front_end(floor):
    found = [
        f"{path.relative_to(ROOT)}: {text}"
        for path in sorted((ROOT / floor).rglob("*.py"))
        for text in sentences_raised(ast.parse(path.read_text(encoding="utf-8")))
        if FRONT_END.search(text)
    ]
    assert found == []
