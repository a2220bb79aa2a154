"""The rows of the tables: the method and what it is compared with (Sec. V)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, Literal

from core.errors import InputError
from core.formats import excerpt
from core.parameters import Parameters, apply_settings, load_preset
from core.parameters.settings import nearest


@dataclass(frozen=True)
class Variant:
    """A method of judging and pouring.

    Attributes:
        name: on the command line.
        title: in the tables.
        changes: parameters that differ from those of the evaluation.
        preset: whose parameters it has instead, but for the seed; none: the evaluation's.
        has_arm: whether the cell's arm pours, of what it can make along its planned path; else a cup that
            moves as imagined, wherever the best pour is.
        by_looks: judged and poured into by the colour images, from a fixed height above the point poured at
            ("offset") or from above the scanned object ("scan"); none: by physics.
    """

    name: str
    title: str
    changes: Mapping[str, Any] = field(default_factory=dict)
    preset: str | None = None
    has_arm: bool = True
    by_looks: Literal["offset", "scan"] | None = None

    def of(self, parameters: Parameters) -> Parameters:
        """Return the variant's parameters."""
        if self.preset is not None:
            parameters = load_preset(self.preset).model_copy(update={"seed": parameters.seed})
        return apply_settings(parameters, dict(self.changes))


METHOD = "imagination"
DEFAULT = (METHOD, "ideal-arm", "paper", "authors")
"""The rows of an evaluation that asks for none: the method, what its arm costs, and the paper's beside it."""
VARIANTS: Mapping[str, Variant] = {
    one.name: one
    for one in (
        Variant(METHOD, "Imagination"),
        Variant("ideal-arm", "Imagination, arm without limits", has_arm=False),
        # Their cell is not ours, whose wrist camera would touch the object at pivots as low as theirs.
        Variant(
            "paper", "The paper's text (preset paper), arm without limits", preset="paper", has_arm=False
        ),
        Variant(
            "authors",
            "The released code (preset authors), arm without limits",
            preset="authors",
            has_arm=False,
        ),
        Variant("papers-choice", "Imagination, the pour chosen by P alone", {"risk.n_tries": 0}),
        Variant("fixed-theta", "Imagination w/ fixed theta", {"pouring.theta_fixed_rad": 0.0}),
        Variant("convex-parts", "Imagination on convex parts (V-HACD)", {"collision.method": "vhacd"}),
        Variant(
            "no-perturbation",
            "Imagination w/o perturbation",
            {"containability.rotation_rad": 0.0, "containability.translation_m_s2": 0.0},
        ),
        Variant("omega", "Imagination, Omega > Omega_thr (tuned)", {"containability.verdict": "omega"}),
        Variant(
            "threshold-0",
            "Imagination, Omega > 0",
            {"containability.verdict": "omega", "containability.omega_threshold": 0.0},
        ),
        # What stands in the place of AffordanceNet: the same procedure with a network of our own.
        Variant("appearance", "Appearance, our network", has_arm=False, by_looks="offset"),
        Variant("appearance-3d", "Appearance w/ 3D scanning", has_arm=False, by_looks="scan"),
    )
}


def variants_of(names: Sequence[str], *, has_images: bool = True) -> tuple[Variant, ...]:
    """Return variants by their names, in the tables' order; `all` means all that can be had.

    Args:
        names: of variants.
        has_images: whether the objects are scanned; without images nothing is judged by looks.

    Raises:
        InputError: there is no such variant, or it needs images.
    """
    known = [*VARIANTS, "all"]
    unknown = next((name for name in names if name not in known), None)
    if unknown is not None:
        said = excerpt(unknown)
        raise InputError(
            f"There is no variant '{said}'; did you mean '{nearest(said, known)}'? "
            f"Known are {', '.join(known)}."
        )
    blind = next(
        (name for name in names if name != "all" and VARIANTS[name].by_looks and not has_images), None
    )
    if blind is not None:
        raise InputError(
            f"The variant '{blind}' judges images, and meshes have none; let the objects be scanned."
        )
    chosen = (one for name, one in VARIANTS.items() if name in names or "all" in names)
    return tuple(one for one in chosen if has_images or not one.by_looks)
