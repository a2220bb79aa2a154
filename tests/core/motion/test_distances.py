import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from core.motion.distances import (
    Cone,
    cone_box_distance,
    cone_segment_distance,
    segment_box_distance,
    segment_segment_distance,
)

CONE = Cone(0.030, 0.0333, 0.111)
STEEP = Cone(0.06, 0.01, 0.05)
CONES = pytest.mark.parametrize("cone", [CONE, STEEP], ids=["cup", "steep"])


def along(start: np.ndarray, end: np.ndarray, n: int) -> np.ndarray:
    return start[..., None, :] + np.linspace(0, 1, n)[:, None] * (end - start)[..., None, :]


def surface(cone: Cone) -> np.ndarray:
    """Points on the surface, less than 1.5 mm apart."""
    angle = np.linspace(0, 2 * np.pi, 300, endpoint=False)
    circle = np.column_stack([np.cos(angle), np.sin(angle), np.zeros(300)])
    share = np.linspace(0, 1, 100)[:, None, None]
    radii = cone.low_radius_m + share * (cone.high_radius_m - cone.low_radius_m)
    side = radii * circle + share * [0, 0, cone.height_m]
    base = share * cone.low_radius_m * circle
    lid = share * cone.high_radius_m * circle + [0, 0, cone.height_m]
    return np.concatenate([side, base, lid]).reshape(-1, 3)


@CONES
def test_distance_of_points(cone: Cone):
    points = np.random.default_rng(0).uniform(-0.2, 0.2, (400, 3))
    dense = surface(cone)
    brute = np.array([np.linalg.norm(dense - point, axis=1).min() for point in points])
    distance = cone.distance(points)
    height = points[:, 2] / cone.height_m
    radius = cone.low_radius_m + height * (cone.high_radius_m - cone.low_radius_m)
    inside = (height > 0) & (height < 1) & (np.hypot(*points.T[:2]) < radius)
    assert (distance[inside] == 0).all()
    assert distance[~inside] == pytest.approx(brute[~inside], abs=5e-4)
    assert cone.nearest(points[inside]) == pytest.approx(points[inside])


@CONES
def test_support_is_the_farthest_point(cone: Cone):
    directions = np.random.default_rng(1).normal(size=(100, 3))
    assert cone.support(directions) == pytest.approx((directions @ surface(cone).T).max(axis=1), abs=1e-3)


@CONES
def test_distance_of_segments(cone: Cone):
    start, end = np.random.default_rng(2).uniform(-0.2, 0.2, (2, 300, 3))
    end[:10] = start[:10]
    places = start[:, None] + np.linspace(0, 1, 2001)[:, None] * (end - start)[:, None]
    brute = cone.distance(places).min(axis=1)
    distance = cone_segment_distance(cone, start, end)
    assert distance == pytest.approx(brute, abs=1e-4)
    assert (distance >= brute - 1e-4).all()


@CONES
def test_distance_of_boxes_is_never_too_large_and_close_where_it_matters(cone: Cone):
    random = np.random.default_rng(3)
    n = 400
    poses = np.tile(np.eye(4), (n, 1, 1))
    poses[:, :3, :3] = Rotation.random(n, random_state=4).as_matrix()
    poses[:, :3, 3] = random.uniform(-0.25, 0.25, (n, 3))
    half = random.uniform(0.02, 0.15, (n, 3))
    dense = surface(cone)
    brute = np.empty(n)
    for k in range(n):
        points = dense @ poses[k, :3, :3].T + poses[k, :3, 3]
        brute[k] = np.linalg.norm(points - np.clip(points, -half[k], half[k]), axis=1).min()
    distance = cone_box_distance(cone, poses, half)
    assert (distance <= brute + 1e-9).all()
    near = (brute > 0.002) & (brute < 0.05)
    low = brute[near] - distance[near]
    assert np.median(low) < 2e-4
    assert np.quantile(low, 0.9) < 1e-3
    assert (distance[brute == 0] <= 1e-9).all()


def test_distance_of_boxes_where_faces_lie_flat():
    poses = np.tile(np.eye(4), (2, 1, 1))
    poses[:, 2, 3] = 0.108, 0.1
    half = np.full((2, 3), 0.1)
    assert cone_box_distance(CONE, poses, half) == pytest.approx([0.008, 0.0], abs=1e-9)


def test_far_boxes_may_be_given_roughly_but_not_below_the_limit():
    poses = np.tile(np.eye(4), (200, 1, 1))
    poses[:, :3, 3] = np.random.default_rng(5).uniform(-0.4, 0.4, (200, 3))
    half = np.full((200, 3), 0.05)
    exact, rough = cone_box_distance(CONE, poses, half), cone_box_distance(CONE, poses, half, 0.01)
    near = exact < 0.01
    assert rough[near] == pytest.approx(exact[near])
    assert (rough[~near] >= 0.01).all()


def test_segment_to_box_is_the_smallest_over_its_points():
    random = np.random.default_rng(0)
    start, end = random.uniform(-1, 1, (2, 2000, 3))
    half = random.uniform(0.05, 0.6, (2000, 3))
    end[:100, 1] = start[:100, 1]
    end[100:120] = start[100:120]
    points = along(start, end, 2001)
    brute = np.linalg.norm(points - np.clip(points, -half[:, None], half[:, None]), axis=-1).min(axis=1)
    exact = segment_box_distance(start, end, half)
    assert np.abs(exact - brute).max() < 5e-4
    assert (exact <= brute + 1e-12).all()
    assert (exact == 0).any()


def test_segment_to_segment_is_the_smallest_over_their_points():
    random = np.random.default_rng(1)
    a, b, c, d = random.uniform(-1, 1, (4, 100, 3))
    d[:20] = c[:20] + 0.7 * (b - a)[:20]
    d[20:25] = c[20:25]
    first, second = along(a, b, 401), along(c, d, 401)
    brute = [np.linalg.norm(p[:, None] - q[None], axis=-1).min() for p, q in zip(first, second, strict=True)]
    exact = segment_segment_distance(a, b, c, d)
    assert np.abs(exact - brute).max() < 5e-4
    assert (exact <= np.array(brute) + 1e-12).all()
