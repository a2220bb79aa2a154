"""Listing the parameters for people: on the terminal, and as the page in the documentation."""

from __future__ import annotations

from typing import Any

from rich.console import Console
from rich.table import Table

from core.parameters import PRESET_NAMES, describe, flatten, load_preset

_COLUMNS = ("name", "value", "range", "meaning", "source")


def show_parameters(preset: str, markdown: bool) -> None:
    """Print all parameters with their values in `preset`, or the page with all presets."""
    if markdown:
        print(parameters_page(), end="")
        return
    values = flatten(load_preset(preset))
    table = Table(*_COLUMNS, box=None, pad_edge=False)
    for fact in describe():
        table.add_row(fact.name, short(values[fact.name]), fact.range_text, fact.doc, fact.source)
    console = Console()
    (console if console.is_terminal else Console(width=240)).print(table)


def parameters_page() -> str:
    """Return docs/parameters.md."""
    presets = {name: flatten(load_preset(name)) for name in PRESET_NAMES}
    lines = [
        "# Parameters",
        "",
        "Made by `poursight parameters --markdown` from the schema that checks every value. Set one with",
        "`--set name=value`; choose a preset with `--preset`. A dash means: as in `default`.",
        "",
        "| name | " + " | ".join(presets) + " | range | meaning | source |",
        "|---" * (len(presets) + 4) + "|",
    ]
    for fact in describe():
        default = presets["default"][fact.name]
        cells = [
            short(values[fact.name]) if name == "default" or values[fact.name] != default else "-"
            for name, values in presets.items()
        ]
        row = [f"`{fact.name}`", *cells, fact.range_text, fact.doc, fact.source]
        lines.append("| " + " | ".join(cell.replace("|", "/") for cell in row) + " |")
    return "\n".join(lines) + "\n"


def short(value: Any) -> str:
    """Return a value as people write it."""
    return f"{value:.6g}" if isinstance(value, float) else str(value)
