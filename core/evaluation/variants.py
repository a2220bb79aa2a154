"""The rows of the tables: the method and what it is compared with (Sec. V)."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from core.errors import InputError
from core.parameters import Parameters, apply_settings
from core.parameters.settings import nearest


@dataclass(frozen=True)
class Variant:
    """A way to judge and pour.

    Attributes:
        name: on the command line.
        title: in the tables.
        changes: parameters that differ from those of the evaluation.
    """

    name: str
    title: str
    changes: Mapping[str, Any]

    def of(self, parameters: Parameters) -> Parameters:
        """Return the variant's parameters."""
        return apply_settings(parameters, dict(self.changes))


METHOD = "imagination"
VARIANTS: Mapping[str, Variant] = {
    one.name: one
    for one in (
        Variant(METHOD, "Imagination", {}),
        Variant("papers-choice", "Imagination, the paper's choice of the pour", {"risk.n_tries": 0}),
        Variant("fixed-theta", "Imagination w/ fixed theta", {"pouring.theta_fixed_rad": 0.0}),
        Variant("convex-parts", "Imagination on convex parts (V-HACD)", {"collision.method": "vhacd"}),
        Variant(
            "no-perturbation",
            "Imagination w/o perturbation",
            {"containability.rotation_rad": 0.0, "containability.translation_m_s2": 0.0},
        ),
        Variant("omega", "Imagination, Omega > Omega_thr (calibrated)", {"containability.verdict": "omega"}),
        Variant(
            "threshold-0",
            "Imagination, Omega > 0",
            {"containability.verdict": "omega", "containability.omega_threshold": 0.0},
        ),
    )
}


def variants_of(names: list[str]) -> tuple[Variant, ...]:
    """Return variants by their names, in the tables' order; `all` stands for all of them.

    Raises:
        InputError: there is no such variant.
    """
    known = [*VARIANTS, "all"]
    unknown = next((name for name in names if name not in known), None)
    if unknown is not None:
        raise InputError(
            f"There is no variant '{unknown}'; did you mean '{nearest(unknown, known)}'? "
            f"Known are {', '.join(known)}."
        )
    return tuple(one for name, one in VARIANTS.items() if name in names or "all" in names)
