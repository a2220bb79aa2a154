"""What differs between two sets of parameters, which may come from other versions of the program."""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import Any

from core.parameters import Parameters, describe, flatten


def default_parameters() -> dict[str, Any]:
    """Return the default ones by dotted name, as plain JSON, as an evaluation keeps them."""
    plain: dict[str, Any] = json.loads(json.dumps(flatten(Parameters())))
    return plain


def parameter_changes(before: Mapping[str, Any], after: Mapping[str, Any]) -> list[tuple[str, str, str, str]]:
    """Return (name, value before, value after, what it means) of each parameter that differs.

    The seed is not among them: an evaluation has several.
    """
    facts = {fact.name: fact for fact in describe()}
    rows = []
    for name in {**before, **after}:
        if name == "seed" or (name in before and name in after and before[name] == after[name]):
            continue
        unit, doc = (facts[name].unit, facts[name].doc) if name in facts else ("", "not in this version")
        rows.append((name, _text(before, name, unit), _text(after, name, unit), doc))
    return rows


def _text(values: Mapping[str, Any], name: str, unit: str) -> str:
    if name not in values:
        return "not there"
    value = values[name]
    if value is None:
        return "automatic"
    if isinstance(value, bool):
        return "yes" if value else "no"
    several = value if isinstance(value, list) else [value]
    text = ", ".join(f"{one:.6g}" if isinstance(one, float) else str(one) for one in several)
    return f"{text} {unit}".rstrip()
