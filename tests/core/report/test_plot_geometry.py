from __future__ import annotations

from dataclasses import replace
from math import cos, pi, sin

import numpy as np
import pytest

from core.imagination.results import Containability
from core.report.plot_geometry import HOLE_RATIO, SHORTEST_AXIS_M, FootprintPlan, PourMapLayout

EIGHT = tuple(np.deg2rad(30) + np.arange(8) * pi / 4)


def test_rings_fill_the_map_from_the_hole_to_its_edge():
    layout = PourMapLayout(EIGHT, 3, radius=100.0)
    assert layout.ring(0)[0] == pytest.approx(100 * HOLE_RATIO)
    assert layout.ring(0)[1] == pytest.approx(layout.ring(1)[0])
    assert layout.ring(2)[1] == pytest.approx(100)


def test_the_middle_of_each_cell_is_found_in_it():
    layout = PourMapLayout(EIGHT, 3)
    for i in range(8):
        for j in range(3):
            radius, angle_rad = layout.middle(i, j)
            assert layout.cell_at(radius * cos(angle_rad), radius * sin(angle_rad)) == (i, j)


def test_hole_outside_and_missing_directions_hold_no_cell():
    layout = PourMapLayout(EIGHT[:1], 3)
    assert layout.cell_at(0.0, 0.0) is None
    assert layout.cell_at(1.1, 0.0) is None
    assert layout.cell_at(-0.5, 0.0) is None  # a single direction takes an eighth of the circle


def test_an_inset_cell_lies_within_its_cell():
    layout = PourMapLayout(EIGHT, 3, radius=100.0)
    outer, inner = layout.cell(2, 1, 2.0)
    low, high = layout.ring(1)
    assert (inner.radius, outer.radius) == pytest.approx((low + 2, high - 2))
    assert outer.begin_rad * outer.radius == pytest.approx((EIGHT[2] - layout.half_rad) * outer.radius + 2)
    assert inner.begin_rad + inner.sweep_rad == pytest.approx(EIGHT[2] - layout.half_rad + 2 / inner.radius)


def test_the_spread_is_drawn_about_the_middle():
    arc = PourMapLayout(EIGHT, 3, radius=100.0).inner_arc(4, 0, 0.5, 5.0)
    assert arc.begin_rad + arc.sweep_rad / 2 == pytest.approx(EIGHT[4])
    assert arc.sweep_rad < pi / 8


def test_the_footprint_is_laid_out_as_it_was_found(tray: Containability):
    assert tray.footprint is not None
    plan = FootprintPlan.of(tray, pivot_radii_m=(0.01, 0.3))
    assert plan.n_kept == tray.n_in
    assert plan.axes_m is not None
    assert plan.axes_m.mean(axis=1) == pytest.approx(np.tile(tray.footprint.center_m[:2], (2, 1)))
    lengths = np.linalg.norm(np.diff(plan.axes_m, axis=1)[:, 0], axis=1)
    assert lengths == pytest.approx(4 * tray.footprint.deviations_m)
    low, high = plan.extent_m()
    assert (high - low >= 0.6).all()  # the largest pivot circle


def test_axes_of_a_single_candy_can_still_be_seen(tray: Containability):
    assert tray.footprint is not None
    lonely = replace(tray, footprint=replace(tray.footprint, deviations_m=np.zeros(2)))
    axes_m = FootprintPlan.of(lonely).axes_m
    assert axes_m is not None
    assert np.linalg.norm(np.diff(axes_m, axis=1)[:, 0], axis=1) == pytest.approx(2 * SHORTEST_AXIS_M)


def test_where_nothing_stayed_there_is_no_centre(block: Containability):
    plan = FootprintPlan.of(block)
    assert plan.center_m is None and plan.axes_m is None
    assert plan.outline_m.min(axis=0) == pytest.approx(block.aabb_m[0, :2])
