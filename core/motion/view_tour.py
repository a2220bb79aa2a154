"""In which order to take views, in which configuration each, and which way from one to the next."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from core.errors import MotionError
from core.geometry import BoolArray, FloatArray
from core.motion.clearance import MotionScene
from core.motion.joint_path import check_path, shorten
from core.motion.roadmap import Roadmap, clear_moves
from core.motion.view_planning import ReachableView

_ALTERNATIVES = 12
"""Configurations considered for each view: other rolls, distances and branches from the same direction."""
_BLOCKED_COST_RAD = 4.0
"""A detour costs about this much more than the straight move."""
_QUALITY_COST_RAD = 3.0
_HOME = b"home"
_RANDOM_SHARE = 1
"""Random configurations for each view: they join what the views alone leave apart."""


@dataclass(frozen=True)
class Stop:
    """A view of a tour.

    Attributes:
        view: what is taken here.
        route_rad: (M, 6) from the stop before to this one, both included; in between are via-points.
    """

    view: ReachableView
    route_rad: FloatArray


class ViewNet:
    """Reachable views that can also be reached from home, with the ways between them."""

    def __init__(
        self,
        scene: MotionScene,
        views: Sequence[ReachableView],
        home_rad: FloatArray,
        min_clearance_m: float,
        seed: int = 0,
    ) -> None:
        """Build the net over home (6,), the views and random configurations."""
        self.scene = scene
        self.home_rad = home_rad
        self.min_clearance_m = min_clearance_m
        joints = np.array([home_rad, *(view.joints_rad for view in views)])
        size = (_RANDOM_SHARE * len(joints), 6)
        random = np.random.default_rng(seed).uniform(joints.min(axis=0), joints.max(axis=0), size)
        random = random[scene.clearance(random).distance_m >= min_clearance_m]
        self._roadmap = Roadmap(scene, np.concatenate([joints, random]), min_clearance_m)
        self._nodes = {_HOME: 0} | {view.joints_rad.tobytes(): k for k, view in enumerate(views, start=1)}
        connected = self._roadmap.connected_to(0)
        self.views = tuple(view for k, view in enumerate(views, start=1) if connected[k])

    def route(self, start: ReachableView | None, goal: ReachableView) -> FloatArray:
        """Return a clear way (M, 6) from a view, or from home (`None`), to another view of the net.

        Raises:
            MotionError: the way over the net is not clear after all when looked at degree by degree.
        """
        here = self.home_rad if start is None else start.joints_rad
        straight = np.array([here, goal.joints_rad])
        if check_path(self.scene, straight, self.min_clearance_m).is_clear:
            return straight
        node = self._nodes[_HOME if start is None else start.joints_rad.tobytes()]
        way = self._roadmap.way(node, self._nodes[goal.joints_rad.tobytes()])
        way = shorten(self.scene, way, self.min_clearance_m)
        problem = check_path(self.scene, way, self.min_clearance_m).problem
        if problem is not None:
            raise MotionError(
                f"The way to the view at {goal.elevation_deg:.0f} degrees of elevation and "
                f"{goal.azimuth_deg:.0f} of azimuth has {problem}; leave this view out."
            )
        return way


def plan_tour(net: ViewNet, chosen: Sequence[ReachableView]) -> tuple[Stop, ...]:
    """Order views of a net into a short tour from home, with a clear way from each to the next.

    A view may be replaced by another of the net from the same direction, where the tour gets shorter by that.

    Raises:
        MotionError: a way turned out not to be clear.
    """
    layers = _order_layers([_alternatives(view, net.views) for view in chosen], net.home_rad)
    views = _best_chain(net, layers)
    return tuple(
        Stop(view, net.route(before, view)) for before, view in zip([None, *views[:-1]], views, strict=True)
    )


def _alternatives(view: ReachableView, all_views: Sequence[ReachableView]) -> list[ReachableView]:
    same = [other for other in all_views if np.allclose(other.direction, view.direction, atol=1e-3)]
    return sorted(same, key=lambda other: other.quality, reverse=True)[:_ALTERNATIVES] or [view]


def _order_layers(layers: list[list[ReachableView]], home_rad: FloatArray) -> list[list[ReachableView]]:
    """Order by 2-opt on the nearest alternatives' distances, beginning near home."""
    n = len(layers)
    joints = [np.array([home_rad])] + [np.array([view.joints_rad for view in layer]) for layer in layers]
    apart = np.array([[_joint_distances(a, b).min() for b in joints] for a in joints])
    order = [0]
    while len(order) <= n:
        left = [k for k in range(1, n + 1) if k not in order]
        order.append(min(left, key=lambda k: apart[order[-1], k]))
    return [layers[k - 1] for k in _two_opt(order, apart)[1:]]


def _two_opt(order: list[int], apart: FloatArray) -> list[int]:
    """Turn stretches of an open tour round for as long as that shortens it; its first place stays."""

    def length(tour: list[int]) -> float:
        return float(apart[tour[:-1], tour[1:]].sum())

    improved = True
    while improved:
        improved = False
        for i in range(1, len(order) - 1):
            for j in range(i + 1, len(order)):
                turned = order[:i] + order[i : j + 1][::-1] + order[j + 1 :]
                if length(turned) < length(order) - 1e-9:
                    order, improved = turned, True
    return order


def _best_chain(net: ViewNet, layers: list[list[ReachableView]]) -> list[ReachableView]:
    """One alternative of each layer so that moves are short, clear and views good (Viterbi)."""
    costs, before = np.zeros(1), np.array([net.home_rad])
    origins = []
    for layer in layers:
        joints = np.array([view.joints_rad for view in layer])
        moves = _joint_distances(before, joints)
        moves += _BLOCKED_COST_RAD * ~_are_clear(net, before, joints)
        total = costs[:, None] + moves
        origins.append(total.argmin(axis=0))
        costs = total.min(axis=0) - _QUALITY_COST_RAD * np.array([view.quality for view in layer])
        before = joints
    k = int(costs.argmin())
    chain = []
    for layer, origin in zip(layers[::-1], origins[::-1], strict=True):
        chain.append(layer[k])
        k = int(origin[k])
    return chain[::-1]


def _joint_distances(starts: FloatArray, goals: FloatArray) -> FloatArray:
    """How far (A, B) the busiest joint turns between configurations (A, 6) and (B, 6)."""
    return np.asarray(np.abs(starts[:, None] - goals[None]).max(axis=-1))


def _are_clear(net: ViewNet, starts: FloatArray, goals: FloatArray) -> BoolArray:
    """Whether (A, B) straight moves are clear, looked at every third degree."""
    i, j = np.divmod(np.arange(len(starts) * len(goals)), len(goals))
    clear = clear_moves(net.scene, starts[i], goals[j], net.min_clearance_m)
    return clear.reshape(len(starts), len(goals))
