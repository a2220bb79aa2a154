from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from core.geometry import look_at
from core.quality.verdict import count_views, unseen_share
from hardware.simulation.objects import builtin_object
from tests.core.quality.studio import PLATFORM_M, on_platform


@pytest.fixture(scope="module")
def block():
    return on_platform(builtin_object("block"))


@pytest.fixture(scope="module")
def one_sided(block, mug_scan):
    """The block seen by one view, from its +x side."""
    pose = look_at([0.6, 0, PLATFORM_M + 0.35], [0, 0, PLATFORM_M + 0.03])
    return replace(mug_scan, frames=block.take([pose]))


def test_one_view_sees_the_top_and_the_side_towards_it(block, one_sided):
    n_views = count_views(block.mesh, one_sided)
    x, _, z = (block.mesh.vertices_m - block.mesh.aabb_min_m).T
    assert set(np.unique(n_views)) == {0, 1}
    assert (n_views[x < 0.01] == 0).mean() > 0.9, "the far side"
    assert (n_views[(x > 0.119) & (z > 0.05)] == 1).mean() > 0.9, "the near side"


def test_the_unseen_share_counts_what_does_not_look_down(block, one_sided):
    length, width, height = block.mesh.extents_m
    sides = 2 * (length + width) * height
    expected = (sides - width * height) / (sides + length * width)
    share = unseen_share(block.mesh, count_views(block.mesh, one_sided))
    assert share == pytest.approx(expected, abs=0.12)
    nothing = np.zeros(len(block.mesh.vertices_m), dtype=np.int64)
    assert unseen_share(block.mesh, nothing) == 1.0
    assert unseen_share(block.mesh, nothing + 1) == 0.0


def test_a_whole_scan_sees_all_of_a_mug(mug, mug_scan):
    n_views = count_views(mug.mesh, mug_scan)
    assert unseen_share(mug.mesh, n_views) < 0.06
    assert np.median(n_views[mug.mesh.vertices_m[:, 2] > PLATFORM_M + 0.01]) > 4


def test_a_view_that_looks_away_or_is_blank_sees_nothing(mug, mug_scan):
    frame = mug_scan.frames[0]
    away = replace(frame, T_base_camera=look_at([0.6, 0, 0.3], [1.2, 0, 0.3]))
    blank = replace(frame, depth_m=np.zeros_like(frame.depth_m))
    assert count_views(mug.mesh, replace(mug_scan, frames=(away, blank))).sum() == 0


def test_a_thin_walls_far_side_is_not_seen_through_it(mug_scan):
    box = on_platform(builtin_object("box"))
    pose = look_at([0.6, 0, PLATFORM_M + 0.05], [0, 0, PLATFORM_M + 0.05])
    n_views = count_views(box.mesh, replace(mug_scan, frames=box.take([pose])))
    x = box.mesh.vertices_m[:, 0] - box.mesh.aabb_max_m[0]
    near = (n_views[np.abs(x) < 1e-4], n_views[np.abs(x + 0.004) < 1e-4])
    assert near[0].max() == 1 and near[1].max() == 0
