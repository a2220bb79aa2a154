"""The order in which to take views, the configuration of each, and the paths between them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from core.errors import MotionError
from core.geometry import BoolArray, FloatArray, IntArray
from core.motion.clearance import MotionScene
from core.motion.joint_path import STEP_RAD, check_path, sample_move, shorten
from core.motion.views import ReachableView

_ALTERNATIVES = 12
"""Configurations considered per view: other rolls, distances and branches from the same direction."""
_BLOCKED_COST_RAD = 4.0
"""A detour costs about this much more than the straight move."""
_QUALITY_COST_RAD = 3.0
_HOME = b"home"
_RANDOM_SHARE = 1
"""Random configurations per view: they connect what the views alone do not."""
_NEIGHBOURS = 10
_COARSE_STEP_RAD = 3 * STEP_RAD
_BATCH = 1000


@dataclass(frozen=True)
class Stop:
    """A view of a tour.

    Attributes:
        view: taken here.
        route_rad: (M, 6) from the previous stop to this one, both included; in between are via-points.
    """

    view: ReachableView
    route_rad: FloatArray


class ViewNet:
    """Views that can be reached from home, with the paths between them."""

    def __init__(
        self,
        scene: MotionScene,
        views: Sequence[ReachableView],
        home_rad: FloatArray,
        min_clearance_m: float,
    ) -> None:
        """Build the roadmap over home (6,), the views and random configurations."""
        self.scene = scene
        self.home_rad = home_rad
        self.min_clearance_m = min_clearance_m
        joints = np.array([home_rad, *(view.joints_rad for view in views)])
        size = (_RANDOM_SHARE * len(joints), 6)
        random = np.random.default_rng(0).uniform(joints.min(axis=0), joints.max(axis=0), size)
        random = random[scene.clearance(random).distance_m >= min_clearance_m]
        self._roadmap = Roadmap(scene, np.concatenate([joints, random]), min_clearance_m)
        self._nodes = {_HOME: 0} | {view.joints_rad.tobytes(): k for k, view in enumerate(views, start=1)}
        connected = self._roadmap.connected_to(0)
        self.views = tuple(view for k, view in enumerate(views, start=1) if connected[k])

    def route(self, start: ReachableView | None, goal: ReachableView) -> FloatArray:
        """Return a clear path (M, 6) from a view, or from home (`None`), to another view of the net.

        Raises:
            MotionError: checked at every degree, the path over the roadmap is not clear after all.
        """
        here = self.home_rad if start is None else start.joints_rad
        straight = np.array([here, goal.joints_rad])
        if check_path(self.scene, straight, self.min_clearance_m).is_clear:
            return straight
        node = self._nodes[_HOME if start is None else start.joints_rad.tobytes()]
        path = self._roadmap.path(node, self._nodes[goal.joints_rad.tobytes()])
        path = shorten(self.scene, path, self.min_clearance_m)
        problem = check_path(self.scene, path, self.min_clearance_m).problem
        if problem is not None:
            raise MotionError(
                f"The path to the view at {goal.elevation_deg:.0f} degrees of elevation and "
                f"{goal.azimuth_deg:.0f} of azimuth has {problem}; leave this view out."
            )
        return path


def plan_tour(net: ViewNet, chosen: Sequence[ReachableView]) -> tuple[Stop, ...]:
    """Order views of a net into a short tour from home, with a clear path from each to the next.

    A view may be replaced by another of the net from the same direction, where that shortens the tour.

    Raises:
        MotionError: a path turned out not to be clear.
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
    """Order by 2-opt on the nearest alternatives' distances, starting near home."""
    joints = [np.array([home_rad])] + [np.array([view.joints_rad for view in layer]) for layer in layers]
    apart = np.array([[_joint_distances(a, b).min() for b in joints] for a in joints])
    return [layers[k - 1] for k in shortest_order(apart)[1:]]


def shortest_order(apart: FloatArray) -> list[int]:
    """Order stops by their distances (N, N) into a short tour that begins at the first and ends anywhere."""
    order = [0]
    while len(order) < len(apart):
        left = [k for k in range(len(apart)) if k not in order]
        order.append(min(left, key=lambda k: apart[order[-1], k]))
    return _two_opt(order, apart)


def _two_opt(order: list[int], apart: FloatArray) -> list[int]:
    """Reverse parts of an open tour while that shortens it; its first stop stays."""

    def length(tour: list[int]) -> float:
        return float(apart[tour[:-1], tour[1:]].sum())

    improved = True
    while improved:
        improved = False
        for i in range(1, len(order) - 1):
            for j in range(i + 1, len(order)):
                reversed_part = order[:i] + order[i : j + 1][::-1] + order[j + 1 :]
                if length(reversed_part) < length(order) - 1e-9:
                    order, improved = reversed_part, True
    return order


def _best_chain(net: ViewNet, layers: list[list[ReachableView]]) -> list[ReachableView]:
    """One alternative of each layer so that moves are short and clear, and views good (Viterbi)."""
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
    """Largest joint displacements (A, B) between configurations (A, 6) and (B, 6)."""
    return np.asarray(np.abs(starts[:, None] - goals[None]).max(axis=-1))


def _are_clear(net: ViewNet, starts: FloatArray, goals: FloatArray) -> BoolArray:
    """Whether (A, B) straight moves are clear, checked at every third degree."""
    i, j = np.divmod(np.arange(len(starts) * len(goals)), len(goals))
    clear = clear_moves(net.scene, starts[i], goals[j], net.min_clearance_m)
    return clear.reshape(len(starts), len(goals))


class Roadmap:
    """Probabilistic roadmap (Kavraki et al. 1996) over given configurations.

    Edges are checked at every third degree; `check_path` must confirm a path before it is executed.
    """

    def __init__(self, scene: MotionScene, joints_rad: FloatArray, min_clearance_m: float) -> None:
        """Connect each of the configurations (N, 6) with its neighbours, where the straight move is clear."""
        from scipy.sparse import coo_array  # late, as everywhere here: it costs the window memory

        self._joints_rad = joints_rad
        edges = _neighbours(joints_rad)
        edges = edges[clear_moves(scene, joints_rad[edges[:, 0]], joints_rad[edges[:, 1]], min_clearance_m)]
        lengths = np.abs(joints_rad[edges[:, 0]] - joints_rad[edges[:, 1]]).max(axis=1)
        n = len(joints_rad)
        # a zero would be no edge
        self._net = coo_array((np.maximum(lengths, 1e-9), (edges[:, 0], edges[:, 1])), shape=(n, n)).tocsr()

    def connected_to(self, node: int) -> BoolArray:
        """Which configurations (N,) can be reached from one of them."""
        from scipy.sparse.csgraph import connected_components

        _, part = connected_components(self._net, directed=False)
        connected: BoolArray = part == part[node]
        return connected

    def path(self, start: int, goal: int) -> FloatArray:
        """The shortest path (M, 6) over the roadmap between two connected configurations."""
        from scipy.sparse.csgraph import dijkstra

        _, before = dijkstra(self._net, False, np.array(start), True)
        nodes = [goal]
        while nodes[-1] != start:
            nodes.append(int(before[nodes[-1]]))
        return self._joints_rad[nodes[::-1]]


def _neighbours(joints_rad: FloatArray) -> IntArray:
    """Pairs (E, 2) of configurations that are close to each other by their largest joint displacement."""
    from scipy.spatial import KDTree

    k = min(_NEIGHBOURS + 1, len(joints_rad))
    near = np.asarray(KDTree(joints_rad).query(joints_rad, k=k, p=np.inf)[1]).reshape(len(joints_rad), k)
    pairs = np.stack([np.repeat(np.arange(len(joints_rad)), k), near.ravel()], axis=1)
    pairs = np.sort(pairs[pairs[:, 0] != pairs[:, 1]], axis=1)
    return np.unique(pairs, axis=0)


def clear_moves(
    scene: MotionScene, starts_rad: FloatArray, goals_rad: FloatArray, min_clearance_m: float
) -> BoolArray:
    """Which (E,) straight moves from (E, 6) to (E, 6) are clear, checked at every third degree."""
    clear = np.ones(len(starts_rad), dtype=bool)
    for k in range(0, len(starts_rad), _BATCH):
        ends = zip(starts_rad[k : k + _BATCH], goals_rad[k : k + _BATCH], strict=True)
        moves = [sample_move(start, goal, _COARSE_STEP_RAD) for start, goal in ends]
        near = scene.clearance(np.concatenate(moves)).distance_m < min_clearance_m
        first = np.cumsum([0] + [len(move) for move in moves[:-1]])
        clear[k : k + _BATCH] = ~np.logical_or.reduceat(near, first)
    return clear
