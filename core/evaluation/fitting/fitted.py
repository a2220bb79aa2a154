"""Which parameters are fitted, and in which range."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from math import radians
from typing import Any

from core.errors import InputError
from core.formats import excerpt
from core.parameters import FieldFacts, Parameters, apply_settings, describe, flatten
from core.parameters.settings import nearest

_THRESHOLDS = ("containability.capacity_threshold", "containability.omega_threshold")
ROLLING, SPINNING = "containability.contact.rolling_friction", "containability.contact.spinning_friction"
CONTAINABILITY: tuple[str, ...] = (
    "containability.rotation_rad",
    "containability.translation_m_s2",
    "containability.contact.lateral_friction",
    ROLLING,
)
"""Fitted to labels unless others are named."""
POURING: tuple[str, ...] = (
    "pouring.contact.lateral_friction",
    "pouring.contact.rolling_friction",
    "pouring.contact.restitution",
)
"""Fitted to measured spills unless others are named."""
_TIED = {ROLLING: SPINNING, "pouring.contact.rolling_friction": "pouring.contact.spinning_friction"}
_JUDGING_GROUPS = ("containability", "particle", "solver")
_SPILLING_GROUPS = ("pouring.contact", "particle")
_DIGITS = 4


@dataclass(frozen=True)
class FittedParameter:
    """A parameter and where to look for it.

    Attributes:
        name: dotted name of `Parameters`.
        low: smallest value.
        high: largest value.
        is_log: whether factors count, not differences.
        tied: dotted names that always get the same value.
    """

    name: str
    low: float
    high: float
    is_log: bool = False
    tied: tuple[str, ...] = ()

    def rounded(self, value: float) -> float:
        """Return a value with as many digits as are written down, within the range."""
        return min(max(float(f"{value:.{_DIGITS}g}"), self.low), self.high)

    def holds(self, value: float) -> bool:
        """Whether a value lies within the range."""
        return self.low <= value <= self.high


_SENSIBLE = {
    one.name: one
    for one in (
        FittedParameter("containability.rotation_rad", radians(1), radians(20)),
        FittedParameter("containability.translation_m_s2", 0.1, 4.0),
        FittedParameter("containability.contact.lateral_friction", 0.005, 0.6, True),
        FittedParameter(ROLLING, 0.001, 0.5, True),
        FittedParameter(SPINNING, 0.001, 0.5, True),
        FittedParameter("containability.contact.restitution", 0.0, 0.6),
        FittedParameter("particle.diameter_m", 0.004, 0.016),
        FittedParameter("particle.height_m", 0.002, 0.01),
        FittedParameter("pouring.contact.lateral_friction", 0.02, 0.8, True),
        FittedParameter("pouring.contact.rolling_friction", 0.001, 0.5, True),
        FittedParameter("pouring.contact.spinning_friction", 0.001, 0.5, True),
        FittedParameter("pouring.contact.restitution", 0.0, 0.6),
    )
}
"""Narrower than what the schema allows: what a hand does, and how sugar slides."""


def fitted_parameters(
    texts: Sequence[str], names: Sequence[str] = CONTAINABILITY
) -> tuple[FittedParameter, ...]:
    """Return what is to be fitted.

    The friction against spinning follows that against rolling unless it is named itself.

    Args:
        texts: `NAME` or `NAME=LOW:HIGH`; none: the usual ones.
        names: the usual ones.

    Raises:
        InputError: a name is unknown, named twice or decides nothing here, or its range is none.
    """
    chosen = [_read(text) for text in texts or names]
    known = [one.name for one in chosen]
    twice = next((name for name in known if known.count(name) > 1), None)
    if twice is not None:
        raise InputError(f"The parameter {twice} is to be fitted twice; name it once.")
    return tuple(_with_tie(one, known) for one in chosen)


def threshold_name(parameters: Parameters) -> str:
    """Return the threshold that decides; it needs no search, for it follows from the scores."""
    return f"containability.{parameters.containability.deciding_threshold_name}"


def is_for_spills(one: FittedParameter) -> bool:
    """Whether measured spills depend on it."""
    return one.name.startswith(_SPILLING_GROUPS)


def start_values(fitted: Iterable[FittedParameter], parameters: Parameters) -> dict[str, float]:
    """Return the values of the parameters to start from."""
    flat = flatten(parameters)
    return {one.name: float(flat[one.name]) for one in fitted}


def settings_of(fitted: Iterable[FittedParameter], values: Mapping[str, float]) -> dict[str, Any]:
    """Return the settings that values mean, those of tied parameters among them."""
    settings: dict[str, Any] = {}
    for one in fitted:
        settings |= dict.fromkeys((one.name, *one.tied), values[one.name])
    return settings


def parameters_of_trial(
    parameters: Parameters, fitted: Iterable[FittedParameter], number: int, values: Mapping[str, float]
) -> Parameters:
    """Return what a trial is made with: the first one with the parameters to start from, tied or not.

    Raises:
        InputError: the values do not fit together.
    """
    return parameters if number == 0 else apply_settings(parameters, settings_of(fitted, values))


def _with_tie(one: FittedParameter, named: Sequence[str]) -> FittedParameter:
    tied = _TIED.get(one.name)
    if tied is None or tied in named:
        return one
    return FittedParameter(one.name, one.low, one.high, one.is_log, (tied,))


def _read(text: str) -> FittedParameter:
    name, has_range, bounds = (part.strip() for part in text.partition("="))
    facts = {fact.name: fact for fact in describe()}
    if name not in facts:
        said = excerpt(name)
        raise InputError(f"There is no parameter '{said}'; did you mean '{nearest(said, facts)}'?")
    _check_use(name)
    usual = _SENSIBLE.get(name) or _by_schema(facts[name])
    if not has_range:
        return usual
    low, high = _bounds(text, bounds)
    given = FittedParameter(name, low, high, usual.is_log and low > 0)
    for bound in (low, high):
        apply_settings(Parameters(), settings_of((given,), {name: bound}))
    return given


def _check_use(name: str) -> None:
    if name in _THRESHOLDS:
        raise InputError(
            f"{name} is not fitted: the deciding threshold is always chosen, from the scores; leave it out."
        )
    if not name.startswith((*_JUDGING_GROUPS, *_SPILLING_GROUPS)):
        raise InputError(
            f"{name} cannot be fitted: labels depend on parameters of {', '.join(_JUDGING_GROUPS)}, "
            f"and measured spills on those of {', '.join(_SPILLING_GROUPS)}."
        )


def _by_schema(fact: FieldFacts) -> FittedParameter:
    is_real = isinstance(fact.default, float)
    if not is_real or fact.low is None or fact.high is None:
        raise InputError(f"{fact.name} cannot be fitted: it is no real number with a range.")
    return FittedParameter(fact.name, float(fact.low), float(fact.high))


def _bounds(text: str, bounds: str) -> tuple[float, float]:
    low, _, high = bounds.partition(":")
    try:
        found = float(low), float(high)
    except ValueError as error:
        raise InputError(f"'{excerpt(text)}' has no range: write NAME=LOW:HIGH, in SI units.") from error
    if not found[0] < found[1]:
        raise InputError(f"'{excerpt(text)}' has no range: LOW must be below HIGH.")
    return found
