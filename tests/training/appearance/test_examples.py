"""The labels of the rendered views come from geometry: each is held against what is known of the object."""

from pathlib import Path

import numpy as np
import pytest

from core.geometry import make_pose, rotation_x
from core.mesh import TriangleMesh
from hardware.simulation.families.catalogue import FAMILIES
from hardware.simulation.objects import builtin_object
from hardware.simulation.world import World
from training.appearance.examples import Subject, development_objects, examples_of, family_subjects
from training.appearance.labels import Hollow

EYES_M = np.array([[0.3, 0.1, 0.5], [0.02, 0.0, 0.7], [-0.4, 0.3, 0.25]])


GROUND_M = np.array([0.0, 0.0, -0.065])


def hollow(mesh: TriangleMesh) -> Hollow:
    return Hollow(mesh, World(mesh, GROUND_M))


def seen(mesh: TriangleMesh, eye_m: np.ndarray) -> np.ndarray:
    """Points (N, 3) of the object that a camera there sees, all around its middle."""
    middle = (mesh.aabb_min_m + mesh.aabb_max_m) / 2
    reach = np.linalg.norm(mesh.extents_m) / 2
    u, v = np.meshgrid(np.linspace(-reach, reach, 90), np.linspace(-reach, reach, 90))
    forward = (middle - eye_m) / np.linalg.norm(middle - eye_m)
    right = np.cross(forward, [0, 0, 1.0])
    right /= np.linalg.norm(right)
    targets = middle + u[..., None] * right + v[..., None] * np.cross(forward, right)
    hits = World(mesh, GROUND_M).cast(eye_m, targets - eye_m)
    return hits.points_m[hits.on_object]


@pytest.mark.parametrize("eye_m", EYES_M)
def test_a_turned_vessel_contains_within_its_inner_wall_below_its_rim(eye_m):
    """The glass: 38 mm outside at the rim, 120 mm tall, wall 3 mm; so its two sides are told apart."""
    mesh = builtin_object("glass")
    points = seen(mesh, eye_m)
    contains = hollow(mesh).contains(points, eye_m)
    radius = np.hypot(points[:, 0], points[:, 1])
    outside_m = np.interp(points[:, 2], [0.0, 0.002, 0.06, 0.119], [0.029, 0.030, 0.034, 0.038])
    is_outer = radius > outside_m - 0.001
    is_inner = (radius < outside_m - 0.002) & (points[:, 2] > 0.0079)
    below_rim = points[:, 2] < 0.118
    assert is_inner.sum() > 30 and is_outer.sum() > 30
    assert contains[is_inner & below_rim].mean() > 0.97
    assert contains[is_outer].mean() < 0.03


@pytest.mark.parametrize("eye_m", EYES_M)
def test_a_belly_over_an_outer_wall_does_not_make_it_contain(eye_m):
    """The vase's foot is narrower than its hollow is above it."""
    mesh = builtin_object("vase")
    points = seen(mesh, eye_m)
    contains = hollow(mesh).contains(points, eye_m)
    assert not contains[points[:, 2] < 0.05].any() or eye_m[2] > 0.6, "only from above is the floor seen"
    # From straight above the mouth of 40 mm, 0.5 m away, covers 0.37 of a belly of 84 mm 0.64 m away.
    assert contains.mean() < 0.4


def test_what_holds_nothing_contains_nowhere():
    for name in ("block", "ring", "holed-cup"):
        mesh = builtin_object(name)
        points = seen(mesh, EYES_M[0])
        assert not hollow(mesh).contains(points, EYES_M[0]).any(), name
    bowl = builtin_object("bowl")
    flipped = bowl.vertices_m @ make_pose(rotation_x(np.pi), np.zeros(3))[:3, :3].T
    over = TriangleMesh(flipped - [0, 0, flipped[:, 2].min()], bowl.faces)
    assert not hollow(over).contains(seen(over, EYES_M[0]), EYES_M[0]).any()


def test_the_same_seed_renders_the_same_views():
    subject = Subject("bowl", "bowl", builtin_object("bowl"), True, False)
    first, again = (list(examples_of(subject, 3, 5)) for _ in range(2))
    for one, other in zip(first, again, strict=True):
        assert one.color.tobytes() == other.color.tobytes()
        assert one.contain.tobytes() == other.contain.tobytes()
        assert one.color.shape == (96, 96, 3) and one.contain.shape == (48, 48)
        assert 0.03 < one.contain.mean() / 255 < 0.7
    assert first[0].color.tobytes() != next(examples_of(subject, 1, 6)).color.tobytes()
    other = Subject("bowl", "bowl", subject.mesh, False, False)
    assert not next(examples_of(other, 1, 5)).contain.any(), "what is no container contains nowhere"


def test_views_are_upright_and_nearness_tells_the_object_from_what_is_behind_it():
    """A box seen from aside: what is above it in the image is behind it."""
    subject = Subject("block", "block", builtin_object("block"), False, False)
    for one in examples_of(subject, 6, 2):
        assert one.nearness.shape == (96, 96)
        middle = one.nearness[40:56, 40:56].astype(float)
        assert 90 < np.median(middle) < 165, "about the object's middle"
        assert one.nearness[:4].mean() < one.nearness[-4:].mean() + 12, "what is above is farther: upright"


def test_only_the_development_half_is_learnt_from_and_an_eighth_of_each_family_is_held_out():
    known = list(family_subjects(18 * 8, 0))
    assert {FAMILIES[one.kind].half for one in known} == {"development"}
    held_out = [one for one in known if one.is_held_out]
    assert {one.name.rpartition("-")[2] for one in held_out} == {"007"}
    assert len({one.kind for one in held_out}) > 8
    labels = {one.is_container for one in known}
    assert labels == {True, False}


def test_of_the_data_set_only_the_development_objects_are_learnt_from(shared_data: Path):
    known = {one.name for one in development_objects(shared_data / "objects")}
    assert "cdb_mug" in known and "ycb_mug" not in known
    assert len(known) == 11
    assert list(development_objects(shared_data / "not there")) == []
