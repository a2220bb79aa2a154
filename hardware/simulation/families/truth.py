"""What is true of an object by construction, and its label: does it hold candies as it stands?"""

from __future__ import annotations

from dataclasses import dataclass
from math import floor, sqrt
from typing import Literal

from core.evaluation.labels import Label
from core.imagination.capacity.stand_in import CANDIES
from core.imagination.particle_shape import particle_volume_m3
from core.mesh import TriangleMesh
from core.mesh_topology import hull_volume_m3
from core.parameters.bodies import ParticleParameters

CANDY = ParticleParameters()
FEWEST_CANDIES = 10
"""Fewer are no filling: whether an object that holds one to nine is a container is left open."""
LEAST_HULL_SHARE = 0.05
"""A hollow of less of the convex hull's volume is a dent; whether it makes a container is left open."""
POURABLE = 2.5
"""Diameters of a candy that a mouth must be wide to be poured into; below, candies arch over it."""
_NEARLY, _CLEARLY = 0.85, 1.5
"""Shares of the width that lets a candy through: up to the first it stays, from the second on it leaves."""
_LOWEST_RIM = 0.5
"""Of a candy's thickness: what lies against a lower rim rolls over it."""


@dataclass(frozen=True)
class Gap:
    """A way through which candies may go.

    Attributes:
        width_m: clear width where it is narrowest; 0: closed.
        shape: of its cross-section.
    """

    width_m: float
    shape: Literal["round", "square", "slot"] = "round"

    @property
    def passing(self) -> float:
        """Its width as a share of the one through which the candy, a spheroid, just passes."""
        across, thick = CANDY.diameter_m, CANDY.height_m
        # Edge on, a candy is an ellipse: a circle must hold its long axis, a square holds it aslant.
        just = {"round": across, "square": sqrt((across**2 + thick**2) / 2), "slot": thick}
        return self.width_m / just[self.shape]


@dataclass(frozen=True)
class Hole:
    """A hole through floor or wall, below the rim.

    Attributes:
        gap: the widest one.
        is_drain: whether all candies come to such a hole; else they also lie beside it.
    """

    gap: Gap
    is_drain: bool


@dataclass(frozen=True)
class Form:
    """An object as it stands on z = 0, in metres, and what is known of its hollow.

    Attributes:
        mesh: closed surfaces, z up.
        capacity_m3: volume below the lowest rim, holes taken as closed.
        depth_m: from the lowest rim down to the deepest point; of several hollows the deepest one's.
        mouth: the narrowest way in from above.
        wall_m: the least thickness of wall or floor; of a solid body its least extent.
        hole: through the wall or the floor; none if it is tight.
        empty_because: why it holds nothing, as the end of a sentence; empty if it has a hollow.
        breach_m: width of the place where the rim is lowest; 0 if it is so low all around.
    """

    mesh: TriangleMesh
    capacity_m3: float
    depth_m: float
    mouth: Gap
    wall_m: float
    hole: Hole | None = None
    empty_because: str = ""
    breach_m: float = 0.0


def solid(mesh: TriangleMesh, wall_m: float, because: str) -> Form:
    """Return an object without a hollow that opens upwards."""
    return Form(mesh, 0.0, 0.0, Gap(0.0), wall_m, empty_because=because)


@dataclass(frozen=True)
class Truth:
    """What is true of an object; lengths in mm, volumes in ml.

    Attributes:
        label: container, non-container, or ambiguous on the border between them.
        reason: of the label, a sentence.
        capacity_ml: to the lowest rim over which water would run, through holes taken as closed.
        capacity_candies: that volume filled with candies in bulk, as densely as far from floor and walls.
        depth_mm: from the lowest rim down to the deepest point.
        mouth_mm: clear width of the narrowest way in from above; 0 if there is none.
        hole_mm: clear width of the widest hole through floor or wall; 0 if it is tight.
        wall_mm: the least thickness.
    """

    label: Label
    reason: str
    capacity_ml: float
    capacity_candies: int
    depth_mm: float
    mouth_mm: float
    hole_mm: float
    wall_mm: float


def truth_of(form: Form) -> Truth:
    """Label an object by what is known of it."""
    label, reason = _label(form)
    return Truth(
        label,
        reason,
        round(form.capacity_m3 * 1e6, 3),
        candies_in(form.capacity_m3),
        round(form.depth_m * 1e3, 2),
        round(form.mouth.width_m * 1e3, 2),
        0.0 if form.hole is None else round(form.hole.gap.width_m * 1e3, 2),
        round(form.wall_m * 1e3, 2),
    )


def candies_in(volume_m3: float) -> int:
    """Return how many candies fill a volume in bulk; against floor and walls a few less find room."""
    return floor(volume_m3 * CANDIES.free / particle_volume_m3(CANDY))


def _label(form: Form) -> tuple[Label, str]:
    against = _reason_against(form)
    if against:
        return "non-container", f"{_capital(against)}."
    doubts = _doubts(form)
    if doubts:
        return "ambiguous", f"{_capital('; '.join(doubts))}."
    held = f"{candies_in(form.capacity_m3)} candies below a rim {_mm(form.depth_m)} above the floor"
    kept = "" if form.hole is None else f", and no candy passes its holes of {_mm(form.hole.gap.width_m)}"
    return "container", f"Holds {held}, through a mouth of {_mm(form.mouth.width_m)}{kept}."


def _reason_against(form: Form) -> str:
    """What makes it no container beyond doubt; empty if nothing does."""
    if form.empty_because:
        return form.empty_because
    if form.mouth.passing < _NEARLY:
        return f"no candy gets in through a mouth of {_mm(form.mouth.width_m)}"
    if form.hole is not None and form.hole.is_drain and form.hole.gap.passing >= _CLEARLY:
        return f"candies leave through holes of {_mm(form.hole.gap.width_m)}"
    if form.breach_m:
        return ""  # Candies lie beside it, and water alone finds it at once.
    if form.depth_m < _LOWEST_RIM * CANDY.height_m:
        return f"the rim is {_mm(form.depth_m)} high, less than half a candy's thickness"
    if candies_in(form.capacity_m3) < 1:
        return f"the hollow of {form.capacity_m3 * 1e6:.1f} ml has no room for a candy"
    return ""


def _doubts(form: Form) -> list[str]:
    """What leaves it open whether it is a container."""
    doubts = []
    if form.hole is not None and form.hole.gap.passing >= _NEARLY:
        shape = "arch over" if form.hole.gap.passing >= 1 else "just stay on"
        doubts.append(f"candies may {shape} holes of {_mm(form.hole.gap.width_m)}")
    if form.mouth.width_m < POURABLE * CANDY.diameter_m:
        doubts.append(f"its mouth of {_mm(form.mouth.width_m)} takes single candies, no stream of them")
    if form.depth_m < CANDY.diameter_m:
        where = f" where it is broken over {_mm(form.breach_m)}" if form.breach_m else ""
        doubts.append(f"the rim is {_mm(form.depth_m)} high{where}, less than a candy is wide")
    n_candies = candies_in(form.capacity_m3)
    if n_candies < FEWEST_CANDIES:
        doubts.append(f"it holds {n_candies} {'candy' if n_candies == 1 else 'candies'} only")
    share = form.capacity_m3 / hull_volume_m3(form.mesh)
    if share < LEAST_HULL_SHARE:
        doubts.append(f"its hollow is a dent of {100 * share:.1f} % of the convex hull")
    return doubts


def _mm(length_m: float) -> str:
    return f"{length_m * 1e3:.3g} mm"


def _capital(text: str) -> str:
    return text[:1].upper() + text[1:]
