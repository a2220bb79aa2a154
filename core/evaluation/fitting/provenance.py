"""Where a fitted preset comes from, kept in its file beside the parameters."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import asdict, dataclass, field
from importlib.metadata import version
from pathlib import Path
from typing import Any

from core.errors import PoursightError, SessionError
from core.evaluation.trials import Measure, measure_word
from core.files import read_json, write_json
from core.parameters import Parameters, difference, flatten
from core.session import explained
from core.session.record import plain, program_versions, utc_now

_KEY = "provenance"


@dataclass(frozen=True)
class Provenance:
    """What a set of parameters was fitted to, and what that brought.

    Attributes:
        source: "mesh" or "scan": how the objects were known.
        preset: the parameters to start from.
        seeds: each object was judged with each.
        objects: label by name.
        left_out: why an object could not be used, by its name.
        search: how the search went; empty if it was stopped before.
        fitted: a table for each parameter: name, range, value before and after, importance.
        before: margin, threshold and accuracy with the parameters to start from, also by seed.
        after: the same with what was found.
        spills: the same of what was fitted to measured spills; empty if nothing was.
        date: ISO 8601, UTC.
        versions: of the program and of what it computes with.
        measure: what margin and threshold are of; presets that do not say are of Omega.
    """

    source: str
    preset: str
    seeds: tuple[int, ...]
    objects: Mapping[str, str]
    left_out: Mapping[str, str] = field(default_factory=dict)
    search: Mapping[str, Any] = field(default_factory=dict)
    fitted: tuple[Mapping[str, Any], ...] = ()
    before: Mapping[str, Any] = field(default_factory=dict)
    after: Mapping[str, Any] = field(default_factory=dict)
    spills: Mapping[str, Any] = field(default_factory=dict)
    date: str = field(default_factory=utc_now)
    versions: Mapping[str, str] = field(
        default_factory=lambda: program_versions() | {"optuna": version("optuna")}
    )
    measure: Measure = "Omega"

    @property
    def sentence(self) -> str:
        """One sentence for a list of presets."""
        parts = []
        if self.after:
            parts.append(
                f"to {len(self.objects)} objects ({self.source}, {len(self.seeds)} seeds): "
                f"{measure_word(self.measure)} margin {self.after['margin']:.3f} instead of "
                f"{self.before['margin']:.3f}, threshold {self.after['threshold']:.3g}, "
                f"{100 * self.after['accuracy']:.1f} % right"
            )
        if self.spills:
            parts.append(
                f"to {self.spills['n']} measured spills: {self.spills['after']:.1f} candies off instead of "
                f"{self.spills['before']:.1f}"
            )
        return f"Fitted on {self.date[:10]} " + ", and ".join(parts) + "."

    def to_table(self) -> dict[str, Any]:
        """Return it as plain JSON."""
        return plain(asdict(self))

    @classmethod
    def from_table(cls, table: Mapping[str, Any]) -> Provenance:
        """Read what `to_table` gave.

        Raises:
            TypeError: something is missing or not known.
            KeyError: something is missing.
        """
        values = dict(table)
        return cls(**values | {"seeds": tuple(values["seeds"]), "fitted": tuple(values["fitted"])})


def write_fitted_preset(
    path: Path, parameters: Parameters, named: Iterable[str], provenance: Provenance
) -> None:
    """Write parameters as a preset that `--preset` takes, with where they come from.

    Args:
        path: of the file; one that is there is replaced.
        parameters: what was found; the seed belongs to a run and is left out.
        named: dotted names that are written even if they are as in the default preset.
        provenance: where they come from.

    Raises:
        SessionError: the file cannot be written.
    """
    values = flatten(parameters)
    differing = difference(parameters, Parameters())
    kept = [name for name in values if (name in differing or name in set(named)) and name != "seed"]
    table = {
        "description": provenance.sentence,
        "parameters": plain({name: values[name] for name in kept}),
        _KEY: provenance.to_table(),
    }
    try:
        with explained(path.parent):
            write_json(path, table)
    except OSError as error:
        raise SessionError(
            f"The preset {path} cannot be written ({error.strerror}); name another file."
        ) from error


def read_provenance(path: Path) -> Provenance | None:
    """Read where a preset comes from; none if its file does not say."""
    try:
        return Provenance.from_table(read_json(path)[_KEY])
    except (PoursightError, KeyError, TypeError, ValueError, AttributeError):
        return None
