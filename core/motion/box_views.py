"""Views chosen for an object of which only the box is known: its sides, its mouth, and the hollow below it.

The object is taken for an open box, the least favourable container of that size: its outside hides only
itself, its inside shows through the mouth alone, to the camera and to its projector.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from itertools import product

import numpy as np

from core.geometry import BoolArray, FloatArray
from core.motion.clearance import MotionScene
from core.motion.joint_path import check_path
from core.motion.view_tour import clear_moves, shortest_order
from core.motion.views import Dome, ReachableView, ViewTask, reachable_views, seen_points

AROUND_BOX = Dome(
    elevations_deg=(20, 35, 50, 60, 70, 80, 85, 90),
    azimuths_deg=tuple(range(-180, 180, 30)),
    distances_m=(0.4, 0.55, 0.75),
    rolls_deg=tuple(range(-180, 180, 45)),
)
_SAMPLES = 5
"""Patches along each edge of a side, ..."""
_FROM_EDGE = 0.02
"""... the first and the last this share of its length from its ends."""
_WIDE_M = 0.2
"""A box wider than this does not fit into one image: views aim at its quarters, too."""
_SHARE_A_VIEW = 0.5
"""How much of what is not known of a patch a view straight onto it tells."""
_HALF_TURN_RAD = np.pi


@dataclass(frozen=True)
class BoxPatches:
    """Places on the inside and the outside of an open box.

    Attributes:
        points_m: (P, 3) in the base frame.
        normals: (P, 3) away from the wall.
        is_inside: (P,) whether only the mouth shows it.
        weights: (P,) what seeing it is worth.
        least_facing: (P,) cosine of the flattest incidence at which it is measured.
        flat_quality: (P,) of a flatter look, which shows the air before it: that does not become solid then.
        box_min_m: (3,) lower corner of the box.
        box_max_m: (3,) upper corner; its top is the mouth.
    """

    points_m: FloatArray
    normals: FloatArray
    is_inside: BoolArray
    weights: FloatArray
    least_facing: FloatArray
    flat_quality: FloatArray
    box_min_m: FloatArray
    box_max_m: FloatArray


@dataclass(frozen=True)
class _Kind:
    """What the patches of one side of a wall have in common; see `BoxPatches`."""

    is_inside: bool
    weight: float
    flattest_deg: float
    flat_quality: float


_OUTSIDE = _Kind(False, 1.0, 75.0, 0.3)
_INSIDE = _Kind(True, 1.0, 75.0, 0.0)
_FLOOR = _Kind(True, 4.0, 75.0, 0.0)
"""It shows from few directions, and its holes decide what the object contains."""
_TOP = _Kind(False, 2.0, 45.0, 0.0)
"""Steep looks alone end on the rim, and so show the air above it."""


def box_patches(box_min_m: FloatArray, box_max_m: FloatArray) -> BoxPatches:
    """Spread patches evenly over the sides, the rim's plane, the inner walls and the floor of a box."""
    shares = np.linspace(_FROM_EDGE, 1 - _FROM_EDGE, _SAMPLES)
    parts = []
    for axis, end in product(range(3), (0.0, 1.0)):
        grid = np.full((_SAMPLES**2, 3), end)
        grid[:, [k for k in range(3) if k != axis]] = np.stack(np.meshgrid(shares, shares), -1).reshape(-1, 2)
        outwards = np.eye(3)[axis] * (1 if end else -1)
        if axis < 2:
            parts += [(grid, outwards, _OUTSIDE), (grid, -outwards, _INSIDE)]
        else:
            parts.append((grid, outwards, _TOP) if end else (grid, -outwards, _FLOOR))
    kinds = [kind for *_, kind in parts]
    n = _SAMPLES**2
    return BoxPatches(
        np.concatenate([box_min_m + grid * (box_max_m - box_min_m) for grid, *_ in parts]),
        np.repeat([normal for _, normal, _ in parts], n, axis=0),
        np.repeat([kind.is_inside for kind in kinds], n),
        np.repeat([kind.weight for kind in kinds], n),
        np.repeat([np.cos(np.radians(kind.flattest_deg)) for kind in kinds], n),
        np.repeat([kind.flat_quality for kind in kinds], n),
        box_min_m,
        box_max_m,
    )


def patch_quality(
    patches: BoxPatches, T_base_camera: FloatArray, task: ViewTask, baseline_m: float
) -> FloatArray:
    """How well (N, P) each camera (N, 4, 4) measures each patch: about the cosine of its incidence, or 0.

    Args:
        patches: what is to be seen.
        T_base_camera: (N, 4, 4) poses of the camera.
        task: with the camera's field of view and least range.
        baseline_m: where its projector is, along its x; what that does not light has no depth.
    """
    eyes = T_base_camera[:, :3, 3]
    projectors = eyes + baseline_m * T_base_camera[:, :3, 0]
    distances_m = np.linalg.norm(eyes[:, None] - patches.points_m, axis=-1)
    facing = _in_front_m(patches, eyes) / distances_m
    quality = np.maximum(np.where(facing > patches.least_facing, facing, 0.0), patches.flat_quality)
    is_seen = seen_points(task, T_base_camera, patches.points_m)
    for origins in (eyes, projectors):
        is_seen &= _in_front_m(patches, origins) > 0
        is_seen &= ~patches.is_inside | _through_mouth(patches, origins)
    return np.asarray(np.where(is_seen, quality, 0.0))


def _in_front_m(patches: BoxPatches, origins_m: FloatArray) -> FloatArray:
    """How far (N, P) each origin (N, 3) is in front of each patch's plane."""
    return np.asarray(((origins_m[:, None] - patches.points_m) * patches.normals).sum(axis=-1))


def _through_mouth(patches: BoxPatches, origins_m: FloatArray) -> BoolArray:
    """Whether (N, P) the straight line from each patch to each origin (N, 3) leaves the box by its top."""
    low, high = patches.box_min_m, patches.box_max_m
    above = origins_m[:, None, 2] - patches.points_m[:, 2]
    share = (high[2] - patches.points_m[:, 2]) / np.maximum(above, 1e-9)
    crossing = patches.points_m[:, :2] + share[..., None] * (origins_m[:, None] - patches.points_m)[..., :2]
    inside = ((crossing >= low[:2]) & (crossing <= high[:2])).all(axis=-1)
    return np.asarray(inside & (origins_m[:, None, 2] > high[2]))


def choose_box_views(
    scene: MotionScene, task: ViewTask, baseline_m: float, n_views: int, dome: Dome = AROUND_BOX
) -> tuple[ReachableView, ...]:
    """Choose up to `n_views` views of an object in the task's box, in a short order; 5 to 15 s.

    Each has a clear straight way from home, so each is reached from every other one through home at the
    least, and the order is free. Greedy: the next view is the one that adds most to what the others tell.

    Args:
        scene: arm and obstacles, the object's keep-out box among them.
        task: the box as the object fills it, down to the platform; its target is not used.
        baseline_m: of the camera's projector.
        n_views: how many at most.
        dome: camera poses about each of the points that are aimed at.
    """
    candidates = _candidates(scene, task, dome)
    if not candidates:
        return ()
    patches = box_patches(task.box_min_m, task.box_max_m)
    poses = np.array([view.T_base_camera for view in candidates])
    tells = _SHARE_A_VIEW * patch_quality(patches, poses, task, baseline_m)
    margin = np.array([view.quality - view.seen_share for view in candidates])
    worth = patches.weights * tells * (1 + margin[:, None])
    unknown = np.ones(len(patches.points_m))
    chosen: list[ReachableView] = []
    while len(chosen) < n_views:
        gains = worth @ unknown
        best = int(gains.argmax())
        if gains[best] <= 0:
            break
        if is_clear_from_home(scene, task, candidates[best]):
            chosen.append(candidates[best])
            unknown *= 1 - tells[best]
        worth[best] = 0
    return in_short_order(scene, chosen, task)


def views_clear_from_home(scene: MotionScene, task: ViewTask, dome: Dome) -> list[ReachableView]:
    """Return the dome's reachable views that have a clear straight way from home, the best first."""
    return [
        view
        for view in near_home(reachable_views(scene, task, dome), task)
        if is_clear_from_home(scene, task, view)
    ]


def in_short_order(
    scene: MotionScene, views: Sequence[ReachableView], task: ViewTask
) -> tuple[ReachableView, ...]:
    """Order views that all have a clear way from home into a short tour that begins there."""
    joints = np.array([task.home_rad, *(view.joints_rad for view in views)])
    n = len(joints)
    straight = np.abs(joints[:, None] - joints[None]).max(axis=-1)
    i, j = np.divmod(np.arange(n * n), n)
    clear = clear_moves(scene, joints[i], joints[j], task.min_clearance_m).reshape(n, n)
    through_home = straight[:, :1] + straight[:1]
    order = shortest_order(np.where(clear, straight, through_home))
    return tuple(views[k - 1] for k in order[1:])


def _candidates(scene: MotionScene, task: ViewTask, dome: Dome) -> list[ReachableView]:
    """Reachable views at all points that are aimed at."""
    views = [
        view
        for target_m in _targets_m(task.box_min_m, task.box_max_m)
        for view in reachable_views(scene, replace(task, target_m=target_m), dome)
    ]
    return near_home(views, task)


def near_home(views: Iterable[ReachableView], task: ViewTask) -> list[ReachableView]:
    """Return those within half a turn of home in every joint: home is then on no way a turn away."""
    return [view for view in views if np.abs(view.joints_rad - task.home_rad).max() < _HALF_TURN_RAD]


def _targets_m(low_m: FloatArray, high_m: FloatArray) -> Iterable[FloatArray]:
    """The middles of rim and body, of a wide box those of its quarters, and the middles of its sides."""
    middle, size = (low_m + high_m) / 2, high_m - low_m
    across = [(-0.25, 0.25) if size[k] > _WIDE_M else (0.0,) for k in (0, 1)]
    heights = (0.5, 0.0) if size[2] > _WIDE_M else (0.0,)
    sides = ((-0.5, 0.0, 0.0), (0.5, 0.0, 0.0), (0.0, -0.5, 0.0), (0.0, 0.5, 0.0))
    for shares in (*product(*across, heights), *sides):
        yield middle + np.array(shares) * size


def is_clear_from_home(scene: MotionScene, task: ViewTask, view: ReachableView) -> bool:
    """Return whether the straight way from home to a view is clear."""
    return check_path(scene, [task.home_rad, view.joints_rad], task.min_clearance_m).is_clear
