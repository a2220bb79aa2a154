"""Parameters on the command line: chosen by options, and listed for people."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from rich.console import Console
from rich.table import Table

from app.library.places import named_preset
from app.library.session_folder import remembered_parameters
from core.errors import InputError
from core.formats import excerpt
from core.parameters import (
    PRESET_NAMES,
    Parameters,
    apply_settings,
    describe,
    difference,
    flatten,
    load_preset,
)

_COLUMNS = ("name", "value", "range", "meaning", "source")


@dataclass(frozen=True)
class Choices:
    """Parameters as chosen on the command line; nothing chosen means what the session was last used with."""

    preset: str | None
    settings: list[str]
    seed: int | None

    def parameters(self, session: Path) -> tuple[str, Parameters]:
        """Return the preset's name and the parameters.

        Raises:
            InputError: an unknown preset or parameter, or a value out of its range.
        """
        preset, parameters = self._base(session)
        settings: dict[str, Any] = dict(named_values("--set", self.settings))
        if self.seed is not None:
            settings["seed"] = self.seed
        return preset, apply_settings(parameters, settings)

    def _base(self, session: Path) -> tuple[str, Parameters]:
        remembered = remembered_parameters(session) if self.preset is None else None
        preset = named_preset(self.preset or "default")
        return remembered or (preset, load_preset(preset))


NOTHING_CHOSEN = Choices(None, [], None)


def named_values(option: str, texts: Sequence[str]) -> dict[str, str]:
    """Return what was given as `NAME=VALUE`, by name.

    Raises:
        InputError: one lacks its value.
    """
    found = {}
    for text in texts:
        name, equals, value = text.partition("=")
        if not equals:
            raise InputError(f"'{option} {excerpt(text)}' lacks a value: write {option} name=value.")
        found[name.strip()] = value.strip()
    return found


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


def print_difference(preset: str, parameters: Parameters) -> None:
    """Print what differs from the preset, on stderr."""
    base = load_preset(preset) if preset in PRESET_NAMES else Parameters()
    for name, (before, after) in difference(parameters, base).items():
        print(f"{name} = {short(after)} (preset {preset}: {short(before)})", file=sys.stderr)


def short(value: Any) -> str:
    """Return a value as people write it."""
    return f"{value:.6g}" if isinstance(value, float) else str(value)
