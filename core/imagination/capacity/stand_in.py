"""What is poured in place of candies where these would be too many: larger balls, and what they stand for."""

from __future__ import annotations

from dataclasses import dataclass
from math import pi, sqrt

from core.imagination.particle_shape import particle_volume_m3, shape_of
from core.parameters import Parameters
from core.parameters.bodies import ContactParameters, ParticleParameters, SolverParameters

_BALL_SUBSTEPS = 2
"""A ball is seen by a wall until its centre is through it, which is long after a hull is lost."""
_LEAST_RATE_HZ = 120
_MOST_FOR_MOUTH = 1.5
"""Times the balls aimed at that a narrow mouth may lead to: then they become larger than it would like."""


@dataclass(frozen=True)
class StandIn:
    """Particles that stand for candies.

    Attributes:
        scale: cube root of a particle's volume over a candy's; 1 for the candy itself.
        particle: its shape.
        contact: its contacts.
        solver: how finely it is computed.
    """

    scale: float
    particle: ParticleParameters
    contact: ContactParameters
    solver: SolverParameters


def ball_diameter_m(particle: ParticleParameters) -> float:
    """Diameter of the ball with a particle's volume."""
    return float((6 / pi * particle_volume_m3(particle)) ** (1 / 3))


def candy_itself(parameters: Parameters) -> StandIn:
    """Return the candy."""
    return StandIn(1.0, parameters.particle, parameters.containability.contact, parameters.solver)


def smaller_candy(parameters: Parameters, scale: float) -> StandIn:
    """Return a candy of the same shape, `scale` times as large."""
    candy, contact = parameters.particle, parameters.containability.contact
    particle = candy.model_copy(
        update={
            "diameter_m": scale * candy.diameter_m,
            "height_m": scale * candy.height_m,
            "mass_kg": scale**3 * candy.mass_kg,
        }
    )
    return StandIn(scale, particle, _slowed(contact, scale), parameters.solver)


def ball_of(parameters: Parameters, scale: float) -> StandIn:
    """Return a ball of `scale` cubed times the volume of a candy.

    A ball costs a fifth of an ellipsoid, for spheres meet a surface in closed form. To fall its own size a
    larger ball takes longer by the root of the scale, so the steps do too.
    """
    candy, contact = parameters.particle, parameters.containability.contact
    ball = candy.model_copy(
        update={
            "shape": "sphere",
            "diameter_m": scale * ball_diameter_m(candy),
            "mass_kg": scale**3 * candy.mass_kg,
        }
    )
    solver = parameters.solver.model_copy(
        update={
            "rate_hz": max(round(parameters.solver.rate_hz / sqrt(scale)), _LEAST_RATE_HZ),
            "substeps": min(parameters.solver.substeps, _BALL_SUBSTEPS),
        }
    )
    return StandIn(scale, ball, _slowed(contact, scale), solver)


def stand_in_for(n_candies: float, mouth_m: float, parameters: Parameters) -> StandIn:
    """Return what stands for so many candies, poured through a mouth so wide (m): balls, if they are many."""
    settings = parameters.capacity
    if n_candies <= settings.n_real:
        return candy_itself(parameters)
    times = n_candies / settings.n_aimed
    widest = mouth_m / settings.widths_in_mouth / ball_diameter_m(parameters.particle)
    least = (times / _MOST_FOR_MOUTH) ** (1 / 3)
    return ball_of(parameters, max(min(times ** (1 / 3), widest), least, 1.0))


def _slowed(contact: ContactParameters, scale: float) -> ContactParameters:
    """The resistance to rolling and spinning has the dimension of a length in Bullet."""
    return contact.model_copy(
        update={
            "rolling_friction": scale * contact.rolling_friction,
            "spinning_friction": scale * contact.spinning_friction,
        }
    )


@dataclass(frozen=True)
class Fit:
    """Share far from everything, and what floor and walls take away, by size times area over volume."""

    free: float
    floor: float
    side: float


BALLS = Fit(0.582, 0.049, 0.0)
CANDIES = Fit(0.600, 0.080, 0.020)
_MOST_FLOOR, _MOST_SIDE = 0.9, 1.4
"""Beyond what was measured the last counts: there nothing is bulk any more."""


@dataclass(frozen=True)
class Surroundings:
    """What a bulk of candies lies against: its volume, and the areas of floor and walls that it touches."""

    volume_m3: float
    floor_m2: float
    side_m2: float


NOWHERE = Surroundings(1.0, 0.0, 0.0)
"""Far from everything."""


def packing_fraction(particle: ParticleParameters, around: Surroundings) -> float:
    """Return the share of a volume that particles fill in bulk."""
    fit = BALLS if shape_of(particle).fills_as_ball else CANDIES
    per_volume = ball_diameter_m(particle) / around.volume_m3
    floor = min(per_volume * around.floor_m2, _MOST_FLOOR)
    return fit.free - fit.floor * floor - fit.side * min(per_volume * around.side_m2, _MOST_SIDE)


def bulk_ml(particle: ParticleParameters, around: Surroundings) -> float:
    """Return what a particle takes up in bulk, in ml."""
    return particle_volume_m3(particle) * 1e6 / packing_fraction(particle, around)
