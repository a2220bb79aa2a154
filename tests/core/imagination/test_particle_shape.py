from typing import get_args

import numpy as np
import pytest

from core.errors import StageError
from core.imagination.particle_shape import (
    ELLIPSOID,
    SHAPES,
    half_heights_m,
    particle_extents_m,
    particle_volume_m3,
)
from core.parameters.bodies import ParticleParameters

FLAT, ON_EDGE = [0.0, 0.0, 0.0, 1.0], [np.sqrt(0.5), 0.0, 0.0, np.sqrt(0.5)]


def particle(shape):
    return ParticleParameters(shape=shape, diameter_m=0.012, height_m=0.006)


def test_every_shape_that_can_be_chosen_is_known():
    assert set(get_args(ParticleParameters.model_fields["shape"].annotation)) == set(SHAPES)


@pytest.mark.parametrize("shape", list(SHAPES))
def test_a_particle_lies_flat_and_stands_on_its_edge(shape):
    heights = half_heights_m(particle(shape), np.array([FLAT, ON_EDGE]))
    flat_m = 0.012 if shape == "sphere" else 0.006
    assert heights == pytest.approx([flat_m / 2, 0.006])
    assert particle_extents_m(particle(shape)).tolist() == [0.012, 0.012, flat_m]


def test_volumes():
    box_m3 = 0.012**2 * 0.006
    assert particle_volume_m3(particle("cylinder")) == pytest.approx(np.pi / 4 * box_m3)
    assert particle_volume_m3(particle("ellipsoid")) == pytest.approx(np.pi / 6 * box_m3)
    assert particle_volume_m3(particle("sphere")) == pytest.approx(np.pi / 6 * 0.012**3)


def test_the_hull_lies_inside_the_ellipsoid_and_touches_it():
    radii = np.linalg.norm(ELLIPSOID.hull_m(2.0, 2.0), axis=1)
    assert radii == pytest.approx(np.ones(len(radii)))


def test_hull_and_skin_come_close_to_the_ellipsoid():
    candy = ParticleParameters()
    skin_m = ELLIPSOID.skin_m(candy)
    hull = ELLIPSOID.hull_m(candy.diameter_m - 2 * skin_m, candy.height_m - 2 * skin_m)
    directions = np.random.default_rng(0).normal(size=(2000, 3))
    directions /= np.linalg.norm(directions, axis=1)[:, None]
    reach_m = (directions @ hull.T).max(axis=1) + skin_m
    half_m = np.array([candy.diameter_m, candy.diameter_m, candy.height_m]) / 2
    true_m = np.linalg.norm(directions * half_m, axis=1)
    assert np.abs(reach_m - true_m).max() < 0.16e-3


@pytest.mark.parametrize("ask", [particle_extents_m, particle_volume_m3])
def test_an_unknown_shape_is_a_sentence_and_never_another_shape(ask):
    cube = particle("sphere").model_copy(update={"shape": "cube"})
    with pytest.raises(StageError, match="particle shape 'cube'"):
        ask(cube)
