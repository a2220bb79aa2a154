"""Filling in a template, and writing a text whole or not at all."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from core.evaluation.plain_text import bounds_text, interval_text, percent, signed
from core.evaluation.trials import measure_word
from core.resources import RESOURCES
from core.session.explaining import explained


def render(template: str, data: Mapping[str, Any]) -> str:
    """Return the HTML of a template of `resources/evaluation`; all text in it is escaped."""
    from jinja2 import Environment, FileSystemLoader, StrictUndefined

    environment = Environment(
        loader=FileSystemLoader([RESOURCES / "evaluation", RESOURCES / "report"]),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.filters |= {
        "percent": percent,
        "interval": interval_text,
        "bounds": bounds_text,
        "signed": signed,
        "word": measure_word,
    }
    return environment.get_template(template).render(data)


def write_whole(path: Path, text: str) -> None:
    """Write a text file, whole or not at all.

    Raises:
        SessionError: the disk is full or the folder may not be written.
    """
    unfinished = path.with_name(f".{path.name}.part")
    with explained(path.parent):
        try:
            unfinished.write_text(text, encoding="utf-8", newline="")
            unfinished.replace(path)
        finally:
            unfinished.unlink(missing_ok=True)
