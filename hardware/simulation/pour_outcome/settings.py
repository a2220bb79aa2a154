"""Parameters of the ground-truth simulation. None is taken from the imagination, which it judges."""

from __future__ import annotations

from math import radians
from typing import Literal

from core.parameters.fields import OURS, Group, choice, quantity

_REAL_CANDY = "plain M&M's; as an ellipsoid 0.65 ml, where displaced water says 0.60 to 0.65"
_ESTIMATE = f"{OURS}: estimate for sugar shells, not measured"


class OutcomeSettings(Group):
    """Candies, contacts, errors of the set-up, and how finely the table computes."""

    engine: Literal["bullet", "mujoco"] = choice(
        "bullet", "What moves the candies: Bullet, or MuJoCo with its own contacts and solver.", source=OURS
    )
    seed: int = quantity(
        0,
        "What is drawn differs with it: sizes, packing, and the directions of the errors.",
        unit="",
        source=OURS,
        low=0,
        high=2**31 - 1,
    )
    n_candies: int = quantity(60, "Candies in the cup.", unit="", source="paper, Sec. IV-C", low=1, high=1000)

    candy_shape: Literal["lentil", "tablet", "ball"] = choice(
        "lentil",
        "lentil: an ellipsoid; tablet: a flat cylinder (in MuJoCo it bounces too high); ball: a sphere.",
        source=_REAL_CANDY,
    )
    candy_diameter_m: float = quantity(
        0.0135, "Mean diameter across.", unit="m", source=_REAL_CANDY, low=0.004, high=0.05
    )
    candy_height_m: float = quantity(
        0.0068,
        "Mean thickness; a ball has none of its own.",
        unit="m",
        source=_REAL_CANDY,
        low=0.003,
        high=0.05,
    )
    candy_mass_kg: float = quantity(
        0.00092, "Mass of a candy of mean size.", unit="kg", source=_REAL_CANDY, low=1e-5, high=0.1
    )
    size_spread: float = quantity(
        0.025, "SD of a candy's size, relative to the mean size.", unit="", source=_ESTIMATE, low=0, high=0.15
    )
    batch_spread: float = quantity(
        0.0,
        "The candies of one pour are larger or smaller by up to this share, all alike; how much is drawn.",
        unit="",
        source=f"{OURS}: sorted sweets are alike; raise it to try others",
        low=0,
        high=0.4,
    )

    candy_friction: float = quantity(
        0.35, "Sliding friction between candies.", unit="", source=_ESTIMATE, low=0.01, high=2
    )
    cup_friction: float = quantity(0.28, "Between candy and cup.", unit="", source=_ESTIMATE, low=0, high=2)
    object_friction: float = quantity(
        0.32, "Between candy and object.", unit="", source=_ESTIMATE, low=0, high=2
    )
    table_friction: float = quantity(
        0.42, "Between candy and table or platform.", unit="", source=_ESTIMATE, low=0, high=2
    )
    rolling_arm_m: float = quantity(
        0.0003,
        "Lever of the resistance to rolling and spinning on cup, object and table.",
        unit="m",
        source=_ESTIMATE,
        low=0,
        high=0.01,
    )
    candy_restitution: float = quantity(
        0.3, "Share of the normal speed kept between candies.", unit="", source=_ESTIMATE, low=0.01, high=1
    )
    wall_restitution: float = quantity(
        0.4, "The same against cup, object, platform and table.", unit="", source=_ESTIMATE, low=0, high=1
    )

    object_error_m: float = quantity(
        0.0014,
        "How far the object stands from where its mesh is; the direction in the plane is drawn.",
        unit="m",
        source=f"{OURS}: nudged, or left over by the calibration",
        low=0,
        high=0.1,
    )
    object_error_rad: float = quantity(
        radians(0.8),
        "How far it is rotated about the vertical; the sense is drawn.",
        unit="rad",
        source=f"{OURS}: nudged, or left over by the calibration",
        low=0,
        high=radians(180),
    )
    cup_slip_m: float = quantity(
        0.0012,
        "How far the cup sits in the hand from where it is believed; the direction is drawn.",
        unit="m",
        source=f"{OURS}: what closing fingers do",
        low=0,
        high=0.05,
    )
    cup_slip_rad: float = quantity(
        radians(0.7),
        "How far it leans in the hand; the direction is drawn.",
        unit="rad",
        source=f"{OURS}: what closing fingers do",
        low=0,
        high=radians(30),
    )
    rim_margin_m: float = quantity(
        0.015,
        "So far above the object's top a candy on a heap still counts as in the object.",
        unit="m",
        source=f"{OURS}: one candy and a little",
        low=0,
        high=0.1,
    )

    rate_hz: int = quantity(200, "Steps per second.", unit="Hz", source=OURS, low=120, high=2000)
    iterations: int = quantity(24, "Iterations of the contact solver.", unit="", source=OURS, low=5, high=500)
    safe_move_m: float = quantity(
        0.0015,
        "A step is computed in parts, so that no candy near walls moves on by more in one of them.",
        unit="m",
        source=OURS,
        low=0.0001,
        high=0.01,
    )
    max_substeps: int = quantity(16, "Most parts of a step.", unit="", source=OURS, low=1, high=64)
    contact_breaking_m: float = quantity(
        0.0015, "Distance at which a contact is forgotten.", unit="m", source=OURS, low=0.0005, high=0.02
    )
    contact_rad_s: float = quantity(
        1000.0,
        "MuJoCo: natural frequency of a contact, a candy on its spring; the stiffer, the smaller its steps.",
        unit="rad/s",
        source=OURS,
        low=100,
        high=5000,
    )
    slow_step_s: float = quantity(
        0.001,
        "MuJoCo: largest step; halved while a candy is faster than 0.1 m/s.",
        unit="s",
        source=OURS,
        low=0.0001,
        high=0.002,
    )
    settle_s: float = quantity(
        1.0,
        "Time in which the candies come to rest in the standing cup.",
        unit="s",
        source=OURS,
        low=0.1,
        high=10,
    )
    rest_s: float = quantity(
        3.0,
        "Longest wait after the path for all candies to come to rest.",
        unit="s",
        source=OURS,
        low=0,
        high=60,
    )
    resting_m_s: float = quantity(
        0.02, "A candy slower than this is at rest.", unit="m/s", source=OURS, low=0.001, high=0.2
    )
    record_interval_s: float = quantity(
        1 / 24, "Time between two recorded moments.", unit="s", source=OURS, low=1 / 240, high=1
    )
