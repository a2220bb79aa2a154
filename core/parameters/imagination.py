"""Parameters of the two imaginations (Sec. III-A, III-B, IV-C)."""

from __future__ import annotations

from math import pi, radians
from typing import Literal

from pydantic import model_validator

from core.parameters.bodies import ContactParameters, CupParameters
from core.parameters.fields import CODE, OURS, PAPER, Group, choice, quantity

N_THETA = 8
"""Pour directions, theta_pour(i) = i pi/4 (Sec. III-B)."""
N_INDENT = 3
"""Indentation distances L_idt(j) of each direction (Sec. III-B)."""


class ContainabilityParameters(Group):
    """Dropping candies and shaking the object (Sec. III-A)."""

    n_max: int = quantity(
        144,
        "N_max: more candies than this are thinned out.",
        unit="",
        source=f"{OURS}: docs/decisions/0052; {CODE}: 289",
        low=1,
        high=5000,
    )
    n_min: int = quantity(64, "N_min: fewer get further layers.", unit="", source=CODE, low=1, high=5000)
    layers: Literal["as_needed", "one_more"] = choice(
        "as_needed",
        "Layers where there are too few candies: N_min / (N_x N_y) rounded up, or rounded down and one more.",
        source=f"{PAPER}, Sec. III-A; {CODE}: one_more",
    )
    two_abreast: Literal["quarters", "edges"] = choice(
        "quarters",
        "Where candies fall across a side with room for two: a quarter of it inside its edges, or at them.",
        source=f"{OURS}: at the edges all of them fall beside a small round cup; {CODE}: edges",
    )
    layer_height_m: float = quantity(
        0.01,
        "Lowest layer above the object's AABB.",
        unit="m",
        source=f"{PAPER}, Sec. III-A",
        low=0.001,
        high=0.5,
    )
    layer_spacing_m: float = quantity(
        0.05, "Distance of the layers.", unit="m", source=f"{PAPER}, Sec. III-A", low=0.001, high=0.5
    )
    pitch_margin_m: float = quantity(
        0.001,
        "Added on each side of a candy's AABB for the grid's pitch.",
        unit="m",
        source=f"{CODE}: Bullet pads its AABB; {PAPER}: none",
        low=0,
        high=0.02,
    )
    jitter_m: float = quantity(
        0.0005,
        "Random shift of each candy, uniform, each way.",
        unit="m",
        source=f"{OURS}; {PAPER}: none",
        low=0,
        high=0.01,
    )
    drop_s: float = quantity(150 / 240, "Time to fall and settle.", unit="s", source=CODE, low=0, high=20)
    rotation_s: float = quantity(
        600 / 240,
        "Time of one rotation there and back; about x, then y.",
        unit="s",
        source=CODE,
        low=0,
        high=20,
    )
    rotation_rad: float = quantity(
        radians(15),
        "Amplitude of the rotation.",
        unit="rad",
        source=f"{OURS}: docs/decisions/0013; {PAPER}, Sec. III-A: pi/60",
        low=0,
        high=radians(60),
    )
    translation_s: float = quantity(
        37.5 / 240, "Time of each of the four horizontal pushes.", unit="s", source=CODE, low=0, high=20
    )
    translation_m_s2: float = quantity(
        0.5, "g_h: strength of each push.", unit="m/s^2", source=f"{PAPER}, Sec. III-A", low=0, high=20
    )
    counted: Literal["room_above", "centre"] = choice(
        "room_above",
        "Which candies count as retained: all with their centre inside the object's AABB, or only those on "
        "top of which another would have its centre inside as well.",
        source=f"{OURS}: docs/decisions/0013; {PAPER}, Sec. III-A: centre",
    )
    verdict: Literal["capacity", "omega"] = choice(
        "capacity",
        "What makes an open container: how much of its convex hull candies fill, or the share Omega of the "
        "dropped candies that stayed.",
        source=f"{OURS}: docs/decisions/0015; {PAPER}, Sec. III-A: omega",
    )
    capacity_threshold: float = quantity(
        0.1,
        "Share of the convex hull's volume above which what it holds makes the object an open container.",
        unit="",
        source=f"{OURS}: docs/decisions/0015",
        low=0,
        high=1,
    )
    omega_threshold: float = quantity(
        0.13,
        "Omega_thr: above it the object is an open container by Omega.",
        unit="",
        source=f"{OURS}: docs/decisions/0013; {PAPER}, Sec. IV-C: 0",
        low=0,
        high=1,
    )
    contact: ContactParameters = ContactParameters(
        lateral_friction=0.2,
        candy_friction=0.04,
        spinning_friction=0.02,
        rolling_friction=0.02,
        restitution=0.01,
    )

    @model_validator(mode="after")
    def _bounds_in_order(self) -> ContainabilityParameters:
        if self.n_min > self.n_max:
            raise ValueError("n_min must not exceed n_max")
        return self

    @property
    def deciding_threshold_name(self) -> Literal["capacity_threshold", "omega_threshold"]:
        """Which of the two thresholds the verdict needs."""
        return "omega_threshold" if self.verdict == "omega" else "capacity_threshold"

    @property
    def deciding_threshold(self) -> float:
        """The threshold that the verdict needs."""
        return self.omega_threshold if self.verdict == "omega" else self.capacity_threshold


class PouringParameters(Group):
    """Pouring from 8 directions at 3 distances (Sec. III-B)."""

    n_pour: int = quantity(
        60, "N_pour: candies in the cup.", unit="", source=f"{PAPER}, Sec. IV-C", low=1, high=1000
    )
    amount: Literal["up_to", "number", "safe", "half"] = choice(
        "up_to",
        "How many candies go in: n_pour but no more than safely fit, n_pour whatever fits, as many as safely "
        "fit, or half of what fits; what one cup does not hold is poured with several.",
        source=f"{OURS}: docs/decisions/0022; {PAPER}: number",
    )
    n_packings: int = quantity(
        1,
        "Different packings of the cup; each pour is imagined with each.",
        unit="",
        source=OURS,
        low=1,
        high=50,
    )
    indent_0_m: float = quantity(
        0.01, "L_0: smallest indentation.", unit="m", source=f"{PAPER}, Sec. III-B", low=-0.2, high=0.2
    )
    indent_step_ratio: float = quantity(
        1 / 9,
        "Delta L as a share of the diagonal of the AABB's top face.",
        unit="",
        source=f"{CODE}; {PAPER}: 1/3",
        low=0,
        high=2,
    )
    gamma_0_rad: float = quantity(
        radians(45) + 0.028575,
        "gamma_0: angle the cup is turned by in all.",
        unit="rad",
        source=f"{CODE}; {PAPER}: 62 degrees",
        low=radians(5),
        high=radians(180),
    )
    settle_s: float = quantity(
        100 / 240, "Time the candies settle in the cup.", unit="s", source=CODE, low=0, high=10
    )
    turn_s: float = quantity(
        500 / 240, "Time of the turn, a quarter of a sine.", unit="s", source=CODE, low=0.1, high=60
    )
    wait_s: float = quantity(100 / 240, "Time after the turn.", unit="s", source=CODE, low=0, high=20)
    pivot_height_m: float = quantity(
        0.01, "z_E above the object's AABB.", unit="m", source=f"{PAPER}, Sec. III-B", low=0.001, high=0.5
    )
    counted: Literal["inside", "above_floor"] = choice(
        "inside",
        "Which candies count as poured in: inside the object's AABB, or not below its floor.",
        source=f"{PAPER}, Sec. III-B; {CODE}: above_floor",
    )
    theta_fixed_rad: float | None = quantity(
        None,
        "Pour from this direction only, against the base frame's x-axis: the paper's comparison "
        "'Imagination w/ fixed theta'; none: from all eight.",
        unit="rad",
        source=f"{PAPER}, Sec. V-B",
        low=-2 * pi,
        high=2 * pi,
    )
    mode: Literal["replay", "full"] = choice(
        "replay",
        "Simulate the cup once per packing and replay its candies' exits, or cup and object together.",
        source=OURS,
    )
    cup: CupParameters = CupParameters()
    contact: ContactParameters = ContactParameters(
        lateral_friction=0.4,
        candy_friction=0.16,
        spinning_friction=0.005,
        rolling_friction=0.005,
        restitution=0.25,
    )


class EvidenceParameters(Group):
    """What is kept to look at afterwards."""

    record_interval_s: float = quantity(
        1 / 24, "Time between two recorded particle poses.", unit="s", source=OURS, low=1 / 240, high=1
    )
    renders: bool = choice(True, "Render stills of the drop and of the 24 pours.", source=OURS)
    films: bool = choice(True, "Render films of the drop and of the chosen pour.", source=OURS)


class CapacityParameters(Group):
    """Filling the object until candies run over."""

    n_fillings: int = quantity(
        2,
        "Independent fillings, of which the mean is taken, of what holds up to filled_once candies.",
        unit="",
        source=OURS,
        low=1,
        high=20,
    )
    filled_once: int = quantity(
        500,
        "What holds more candies by its geometry is filled once: its hollow is told, and no amount that is "
        "poured comes near it.",
        unit="",
        source=f"{OURS}: docs/decisions/0052",
        low=0,
        high=1_000_000,
    )
    n_aimed: int = quantity(
        64,
        "Balls that a filling aims at: what holds more is filled with larger ones.",
        unit="",
        source=OURS,
        low=20,
        high=5000,
    )
    n_real: int = quantity(
        30,
        "Up to so many expected candies it is filled with candies; with balls of their volume above.",
        unit="",
        source=OURS,
        low=0,
        high=5000,
    )
    widths_in_mouth: float = quantity(
        2.5,
        "Larger candies are at most as large that so many lie side by side in the mouth.",
        unit="",
        source=OURS,
        low=1,
        high=20,
    )
    rain_m_s: float = quantity(
        0.4, "Speed of the candies where they are let go.", unit="m/s", source=OURS, low=0.05, high=2
    )
    lattice_points: int = quantity(
        500_000,
        "Points of the lattice on which the geometric volume is found.",
        unit="",
        source=OURS,
        low=10_000,
        high=50_000_000,
    )


N_TILT_DIRECTIONS = 8
"""Directions of tilt, i pi/4 from the footprint's principal axis, as those of the pours (Sec. III-B)."""


class RetentionParameters(Group):
    """Tilting the object until the candies leave."""

    n_load: int = quantity(
        24,
        "Candies poured onto the footprint before the tilt; what of them comes to rest inside is the load.",
        unit="",
        source=f"{OURS}: less than N_pour = 60, so that small objects have room for them; not in the paper",
        low=1,
        high=1000,
    )
    layer_spacing_m: float = quantity(
        0.01, "Distance of the layers they fall in.", unit="m", source=OURS, low=0.001, high=0.5
    )
    settle_s: float = quantity(1.5, "Longest time to come to rest.", unit="s", source=OURS, low=0.1, high=20)
    tilt_step_rad: float = quantity(
        radians(3), "Step of the tilt.", unit="rad", source=OURS, low=radians(0.5), high=radians(15)
    )
    tilt_max_rad: float = quantity(
        pi / 2, "Largest tilt.", unit="rad", source=OURS, low=radians(5), high=pi / 2
    )
    hold_s: float = quantity(
        0.25,
        "Longest time at each step; it ends as soon as the candies rest.",
        unit="s",
        source=OURS,
        low=0.05,
        high=10,
    )
    rest_m_s: float = quantity(
        0.05, "Candies slower than that rest.", unit="m/s", source=OURS, low=0.001, high=0.5
    )
