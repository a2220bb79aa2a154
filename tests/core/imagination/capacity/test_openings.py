"""Openings below a heap: a closed floor has none, and the outside of an object is none."""

import numpy as np
import pytest

from core.imagination.capacity import openings
from core.imagination.capacity.water import find_basin
from core.mesh import TriangleMesh
from core.mesh_topology import join
from tests.core.imagination.capacity.conftest import open_box, turned
from tests.core.imagination.rendering.conftest import box_mesh

WIDTH_M = 0.0049
"""The least thickness of a candy that is 0.7 times as large."""


def has_opening_below(mesh, places_m, width_m):
    hollows = find_basin(mesh, 0.0132, 1.0, 100_000).hollow_map
    return openings.has_opening_below(mesh, places_m, hollows, width_m)


def ring_of_places(radius_m, n=24, center_m=(0.0, 0.0)):
    angles = np.linspace(0, 2 * np.pi, n, endpoint=False)
    return np.asarray(center_m) + radius_m * np.column_stack([np.cos(angles), np.sin(angles)])


def funnel(hole_m):
    low, high = hole_m / 2, 0.06
    return turned([(low, 0), (high, 0.06), (high + 0.003, 0.06), (low + 0.003, 0), (low, 0)])


@pytest.mark.parametrize(("hole_m", "is_open"), [(0.02, True), (0.008, True), (0.003, False)])
def test_a_funnel_has_one_if_its_hole_is_wide_enough(hole_m, is_open):
    found = has_opening_below(funnel(hole_m), ring_of_places(0.03), WIDTH_M)
    assert found == is_open


@pytest.mark.parametrize("notch_m", [None, (0.05, 0.04)])
def test_a_closed_floor_has_none_and_what_lies_beside_it_is_none(notch_m):
    tray = open_box((0.08, 0.05, 0.04), 0.002, notch_m)
    assert not has_opening_below(tray, tray.vertices_m[:, :2], WIDTH_M)


def test_a_frame_with_a_gap_in_it_has_one():
    ring = turned([(0.04, 0), (0.05, 0), (0.05, 0.01), (0.04, 0.01), (0.04, 0)])
    middles = ring.vertices_m[ring.faces].mean(axis=1)
    with_gap = TriangleMesh(ring.vertices_m, ring.faces[np.abs(middles[:, 1]) + (middles[:, 0] < 0) > 0.008])
    for mesh in (ring, with_gap):
        assert has_opening_below(mesh, ring_of_places(0.045), WIDTH_M)


def test_too_few_places_to_be_between_leave_it_open():
    assert has_opening_below(funnel(0.02), np.array([[0.03, 0.0]]), WIDTH_M)


def test_what_holds_candies_has_one_wherever_the_last_ones_stayed():
    """Of the four corners of a grid above a pipe one lost its candies: between the others is no opening."""
    pipe = [(0.006, 0), (0.016, 0), (0.016, 0.1), (0.014, 0.1), (0.014, 0.002), (0.006, 0.002), (0.006, 0)]
    beside = np.array([[0.009, 0.009], [0.009, -0.007], [0.003, 0.009]])
    assert has_opening_below(turned(pipe), beside, 0.0085)
    assert not has_opening_below(turned(pipe), beside, 0.0125)
    closed = turned([(0, 0), *pipe[1:5], (0, 0.002)])
    assert not has_opening_below(closed, beside, 0.0085)


def test_bars_thinner_than_a_lattice_would_see_close_what_is_between_them():
    bars = [
        box_mesh(np.array([0.009 * k, -0.04, 0.0]), np.array([0.009 * k + 0.001, 0.04, 0.002]))
        for k in range(-5, 6)
    ]
    grate = join(bars)
    places = ring_of_places(0.03)
    assert has_opening_below(grate, places, 0.007)
    assert not has_opening_below(grate, places, 0.009)
