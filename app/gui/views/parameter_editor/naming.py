"""How parameters are called and written for people: names without suffixes, mm, degrees and grams."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass
from html import escape
from math import degrees, radians
from typing import Any

from PySide6.QtCore import QCoreApplication

from core.parameters import FieldFacts

_SUFFIXES = ("_m_s2", "_rad", "_hz", "_kg", "_m", "_s")
_WORDS = {"aabb": "AABB", "vhacd": "V-HACD", "coacd": "CoACD", "idt": "L_idt"}
_KINDS = {"s": "time", "rad": "angle", "m/s^2": "strength"}
"""Distinguishes two parameters that differ by their unit only."""
_FACTORS = {"m": ("mm", 1000.0), "kg": ("g", 1000.0), "rad": ("°", 0.0), "m/s^2": ("m/s²", 1.0)}


def human_words(name: str) -> str:
    """Return `n_max` as `n max`, `vhacd_hulls` as `V-HACD hulls`."""
    return " ".join(_WORDS.get(word, word) for word in name.split("_"))


def _bare(name: str) -> str:
    """The last part of a dotted name without its unit."""
    leaf = name.rsplit(".", 1)[-1]
    return next((leaf.removesuffix(suffix) for suffix in _SUFFIXES if leaf.endswith(suffix)), leaf)


def _group_and_bare(fact: FieldFacts) -> tuple[str, str]:
    return fact.name.rpartition(".")[0], _bare(fact.name)


def _capital(text: str) -> str:
    return text[:1].upper() + text[1:]


def titles(facts: list[FieldFacts]) -> dict[str, str]:
    """Return `{dotted name: title}`, with the kind of quantity where two in a group would be alike."""
    alike = Counter(map(_group_and_bare, facts))
    found: dict[str, str] = {}
    for fact in facts:
        kind = f" {_KINDS.get(fact.unit, fact.unit)}" if alike[_group_and_bare(fact)] > 1 else ""
        found[fact.name] = _capital(human_words(_bare(fact.name))) + kind
    return found


def group_title(name: str) -> str:
    """Return the heading of a group from its (not dotted) name."""
    return _capital(human_words(name))


@dataclass(frozen=True)
class Display:
    """How one parameter's values are written.

    Attributes:
        facts: the parameter.
        unit: the unit people read.
    """

    facts: FieldFacts
    unit: str

    @classmethod
    def of(cls, facts: FieldFacts) -> Display:
        """Choose the unit: mm for m, degrees for rad, grams for kg."""
        return cls(facts, _FACTORS.get(facts.unit, (facts.unit, 1.0))[0])

    def to_shown(self, value: float) -> float:
        """Return a value in the shown unit; 12 digits, so that 0.0333 m reads 33.3 mm."""
        if self.facts.unit == "rad":
            return float(f"{degrees(value):.12g}")
        return float(f"{value * self._factor():.12g}")

    def to_data(self, shown: float) -> float:
        """Return a shown number in the parameter's own unit."""
        if self.facts.unit == "rad":
            return radians(shown)
        return float(f"{shown / self._factor():.12g}")

    def _factor(self) -> float:
        return _FACTORS.get(self.facts.unit, ("", 1.0))[1]

    def number(self, value: float) -> str:
        """Return a number in the shown unit, all its digits but without the unit."""
        if isinstance(value, int) and not isinstance(value, bool) and self._factor() == 1.0:
            return str(value)
        return f"{self.to_shown(value):.10g}"

    def text(self, value: Any) -> str:
        """Return a value as it is read, with its unit."""
        if value is None:
            return QCoreApplication.translate("ParameterEditor", "automatic")
        if isinstance(value, bool):
            yes = QCoreApplication.translate("ParameterEditor", "yes")
            return yes if value else QCoreApplication.translate("ParameterEditor", "no")
        if isinstance(value, str):
            return human_words(value)
        if isinstance(value, (tuple, list)):
            return self._with_unit(", ".join(self.number(number) for number in value))
        return self._with_unit(self.number(value))

    def _with_unit(self, text: str) -> str:
        if not self.unit:
            return text
        return text + self.unit if self.unit == "°" else f"{text} {self.unit}"

    def range_text(self) -> str:
        """Return the range in the shown unit, or the choices."""
        if self.facts.choices:
            return ", ".join(human_words(word) for word in self.facts.choices)
        if self.facts.low is None or self.facts.high is None:
            return ""
        low = self.number(self.facts.low)
        return QCoreApplication.translate("ParameterEditor", "{low} to {high}").format(
            low=low, high=self._with_unit(self.number(self.facts.high))
        )

    def is_outside(self, value: Any) -> bool:
        """Whether a number lies outside the parameter's own range."""
        low, high = self.facts.low, self.facts.high
        if low is None or high is None or not isinstance(value, (int, float)):
            return False
        return not low <= value <= high

    def tooltip(self) -> str:
        """Return all there is to know, as rich text, which wraps: what it is, range, source, dotted name."""
        tr = QCoreApplication.translate
        lines = [self.facts.doc]
        if self.range_text():
            lines.append(tr("ParameterEditor", "Range: {range}").format(range=self.range_text()))
        elif self.unit:
            lines.append(tr("ParameterEditor", "Unit: {unit}").format(unit=self.unit))
        if self.facts.source:
            lines.append(tr("ParameterEditor", "Source: {source}").format(source=self.facts.source))
        lines.append(tr("ParameterEditor", "Name: {name}").format(name=self.facts.name))
        return "<qt>" + "<br>".join(escape(line) for line in lines) + "</qt>"
