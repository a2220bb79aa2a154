"""Parameters of what falls in the imaginations, and of the physics that lets it (Sec. III-A, III-B, IV-C)."""

from __future__ import annotations

from typing import Literal

from pydantic import model_validator

from core.parameters.fields import CODE, OURS, PAPER, Group, choice, quantity

_CHOSEN = f"{OURS}: docs/decisions/0013, 0014 and 0020"


class ParticleParameters(Group):
    """The candy (Sec. IV-C)."""

    shape: Literal["cylinder", "ellipsoid", "sphere"] = choice(
        "ellipsoid",
        "Implicit cylinder (what the released code's candy acts as), ellipsoid hull (the paper's) or sphere.",
        source=f"{PAPER}, Sec. IV-C; {CODE}: cylinder",
    )
    diameter_m: float = quantity(
        0.0132,
        "Diameter across.",
        unit="m",
        source=f"plain M&M's; {CODE}: 0.007, with the collision margin",
        low=0.001,
        high=0.05,
    )
    height_m: float = quantity(
        0.007,
        "Thickness; a sphere has none of its own.",
        unit="m",
        source=f"plain M&M's; {CODE}: 0.0028, with the collision margin",
        low=0.001,
        high=0.05,
    )
    mass_kg: float = quantity(
        0.0009, "Mass of one.", unit="kg", source=f"plain M&M's; {CODE}: 0.0003", low=1e-5, high=0.1
    )


class CupParameters(Group):
    """The cup: a truncated cone, open at its wide end (Sec. III-B)."""

    length_m: float = quantity(
        0.111, "From base to mouth, outside.", unit="m", source=CODE, low=0.02, high=0.4
    )
    mouth_radius_m: float = quantity(
        0.0333, "Outer radius of the mouth.", unit="m", source=CODE, low=0.01, high=0.2
    )
    slant_rad: float = quantity(
        0.028575, "Slant of the inner wall against the axis.", unit="rad", source=CODE, low=0, high=0.5
    )
    wall_m: float = quantity(
        0.002, "Thickness of wall and base.", unit="m", source=CODE, low=0.0005, high=0.02
    )
    pivot_lift_m: float = quantity(
        0.0,
        "How far above the inner rim's lowest point the pivot lies.",
        unit="m",
        source=f"{PAPER}, Sec. III-B: at the rim; {CODE}: 0.003",
        low=0,
        high=0.02,
    )

    @model_validator(mode="after")
    def _base_is_open(self) -> CupParameters:
        if self.base_inner_radius_m <= 0.002:
            raise ValueError("the cup narrows to a point: shorten length_m or lessen slant_rad")
        return self

    @property
    def base_inner_radius_m(self) -> float:
        """Inner radius where the wall meets the base."""
        from math import tan

        return self.mouth_radius_m - self.wall_m - (self.length_m - self.wall_m) * tan(self.slant_rad)


class ContactParameters(Group):
    """Coulomb friction and restitution of a contact, as a pair of bodies has it."""

    lateral_friction: float = quantity(
        0.5,
        "Sliding friction between candy and object or cup.",
        unit="",
        source=f"{_CHOSEN}; {CODE}: its candy's value times the object's 1",
        low=0,
        high=5,
    )
    candy_friction: float = quantity(
        0.5,
        "Sliding friction between candies.",
        unit="",
        source=f"{_CHOSEN}; {CODE}: the square of its candy's value",
        low=1e-6,
        high=5,
    )
    spinning_friction: float = quantity(
        0.0,
        "Friction between candy and object or cup against spinning about the contact normal.",
        unit="",
        source=f"{_CHOSEN}; {CODE}: its candy's value times the object's 1",
        low=0,
        high=5,
    )
    rolling_friction: float = quantity(
        0.0,
        "The same against rolling.",
        unit="",
        source=f"{_CHOSEN}; {CODE}: its candy's value times the object's 1",
        low=0,
        high=5,
    )
    restitution: float = quantity(
        0.1,
        "Share of the normal speed that a candy keeps, whatever it meets.",
        unit="",
        source=f"{PAPER}, Sec. IV-C; {CODE}: 0.1 times 0.1 in the drop, 0 in the pour",
        low=0,
        high=1,
    )


class SolverParameters(Group):
    """How finely Bullet computes."""

    rate_hz: int = quantity(
        240, "Steps per second.", unit="Hz", source=f"{PAPER}, Sec. III-A", low=60, high=4000
    )
    substeps: int = quantity(
        10,
        "Most parts a step is computed in, so that no candy near the object moves on by more than twice its "
        "skin, a ball by its radius; with 1, fast ones may slip through walls.",
        unit="",
        source=OURS,
        low=1,
        high=32,
    )
    iterations: int = quantity(
        20,
        "Iterations of the contact solver.",
        unit="",
        source=f"{OURS}; {CODE}: 50, which changes nothing beyond the noise (decision 0020)",
        low=1,
        high=500,
    )
    contact_breaking_m: float = quantity(
        0.001,
        "Distance at which a contact is forgotten.",
        unit="m",
        source=f"{OURS}; {CODE}: 0.02",
        low=0.0001,
        high=0.05,
    )
