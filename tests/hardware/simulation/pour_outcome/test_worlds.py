"""The worlds that judge share nothing with the imagination, nor with each other."""

from itertools import combinations

import numpy as np
import pytest

from core.errors import InputError
from core.geometry import FloatArray, ellipsoid_inertia_kg_m2
from core.imagination.particle_shape import ELLIPSOID, particle_volume_m3
from core.parameters import Parameters
from hardware.simulation.pour_outcome.candies import hull_m, inertia_kg_m2, skin_m, thickness_m
from hardware.simulation.pour_outcome.settings import OutcomeSettings
from hardware.simulation.pour_outcome.worlds import WORLDS, worlds_with

IMAGINED = Parameters()
CLOSE = 0.01
"""What differs by less than this share counts as the same."""
EVERY = pytest.mark.parametrize("world", WORLDS.values(), ids=WORLDS)


def differ(one: float, other: float) -> bool:
    return abs(one - other) > CLOSE * max(abs(one), abs(other))


def volume_m3(world: OutcomeSettings) -> float:
    across_m, thick_m = world.candy_diameter_m, thickness_m(world)
    return {"lentil": np.pi / 6, "ball": np.pi / 6, "tablet": np.pi / 4}[
        world.candy_shape
    ] * across_m**2 * thick_m  # fmt: skip


@EVERY
def test_candies_are_of_another_size_mass_and_inertia(world: OutcomeSettings) -> None:
    particle = IMAGINED.particle
    imagined: FloatArray = ellipsoid_inertia_kg_m2(particle.mass_kg, particle.diameter_m, particle.height_m)
    assert differ(world.candy_diameter_m, particle.diameter_m)
    assert differ(thickness_m(world), particle.height_m)
    assert differ(world.candy_mass_kg, particle.mass_kg)
    assert differ(volume_m3(world), particle_volume_m3(particle))
    assert all(differ(one, other) for one, other in zip(inertia_kg_m2(world, 1.0), imagined, strict=True))


def test_a_lentil_in_bullet_has_another_hull_and_another_skin() -> None:
    particle, world = IMAGINED.particle, WORLDS["bullet"]
    imagined = ELLIPSOID.hull_m(1.0, 1.0)
    hull = hull_m(world, 1.0)
    assert len(hull) != len(imagined)
    assert differ(skin_m(world, 1.0), ELLIPSOID.skin_m(particle))
    heights = {round(float(z), 3) for z in np.unique(hull[:, 2] / hull[:, 2].max())}
    of_imagined = {round(float(z), 3) for z in np.unique(imagined[:, 2] / imagined[:, 2].max())}
    assert heights & of_imagined == {-1.0, 0.0, 1.0}, "only poles and equator are alike"


@EVERY
def test_contacts_errors_and_solver_are_others(world: OutcomeSettings) -> None:
    frictions = (world.candy_friction, world.cup_friction, world.object_friction, world.table_friction)
    restitutions = (world.candy_restitution, world.wall_restitution)
    for contact in (IMAGINED.pouring.contact, IMAGINED.containability.contact):
        assert all(differ(one, contact.lateral_friction) for one in frictions)
        assert all(differ(one, contact.restitution) for one in restitutions)
        assert differ(world.rolling_arm_m, contact.rolling_friction)
    risk, solver = IMAGINED.risk, IMAGINED.solver
    assert differ(world.object_error_m, risk.object_error_m)
    assert differ(world.object_error_rad, risk.object_error_rad)
    assert differ(world.cup_slip_m, risk.cup_error_m)
    assert differ(world.cup_slip_rad, risk.cup_error_rad)
    assert differ(world.size_spread, risk.candy_spread)
    assert differ(world.rate_hz, solver.rate_hz)
    assert differ(world.iterations, solver.iterations)
    assert differ(world.contact_breaking_m, solver.contact_breaking_m)


SHARED = {
    "engine", "seed", "n_candies", "candy_shape", "batch_spread", "rim_margin_m",
    "rate_hz", "iterations", "safe_move_m", "max_substeps", "contact_breaking_m", "contact_rad_s",
    "slow_step_s", "settle_s", "rest_s", "resting_m_s", "record_interval_s",
}  # fmt: skip
"""How the worlds compute and count; two of them may have it in common."""


@pytest.mark.parametrize(("one", "other"), list(combinations(WORLDS, 2)))
def test_no_two_worlds_have_a_candy_a_contact_or_an_error_in_common(one: str, other: str) -> None:
    first, second = WORLDS[one].model_dump(), WORLDS[other].model_dump()
    same = {name for name in first if name not in SHARED and not differ(first[name], second[name])}
    assert same == set()
    assert differ(volume_m3(WORLDS[one]), volume_m3(WORLDS[other]))


def test_an_unknown_world_is_a_sentence() -> None:
    with pytest.raises(InputError, match="no ground-truth world 'moon'; there are bullet, mujoco, peanuts"):
        worlds_with(["moon"], {})


def test_all_worlds_take_the_same_change() -> None:
    changed = worlds_with(["mujoco", "peanuts"], {"object_error_m": 0.005})
    assert [one.object_error_m for one in changed.values()] == [0.005, 0.005]
    assert list(changed) == ["mujoco", "peanuts"]
