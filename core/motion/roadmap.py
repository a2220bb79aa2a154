"""A net of clear straight moves between many configurations: what can be reached, and which way."""

from __future__ import annotations

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components, dijkstra
from scipy.spatial import KDTree

from core.geometry import BoolArray, FloatArray, IntArray
from core.motion.clearance import MotionScene
from core.motion.joint_path import STEP_RAD, sample_move

_COARSE_STEP_RAD = 3 * STEP_RAD
_BATCH = 1000


class Roadmap:
    """Probabilistic roadmap (Kavraki et al. 1996) over given configurations.

    Edges are checked at every third degree; ask `check_path` about a way before it is driven.
    """

    def __init__(
        self, scene: MotionScene, joints_rad: FloatArray, min_clearance_m: float, n_neighbours: int = 10
    ) -> None:
        """Join each of the configurations (N, 6) with those next to it, where the straight move is clear."""
        self._joints_rad = joints_rad
        edges = _neighbours(joints_rad, n_neighbours)
        edges = edges[clear_moves(scene, joints_rad[edges[:, 0]], joints_rad[edges[:, 1]], min_clearance_m)]
        lengths = np.abs(joints_rad[edges[:, 0]] - joints_rad[edges[:, 1]]).max(axis=1)
        n = len(joints_rad)
        # a zero would be no edge
        self._net = coo_array((np.maximum(lengths, 1e-9), (edges[:, 0], edges[:, 1])), shape=(n, n)).tocsr()

    def connected_to(self, node: int) -> BoolArray:
        """Which configurations (N,) can be reached from one of them."""
        _, part = connected_components(self._net, directed=False)
        connected: BoolArray = part == part[node]
        return connected

    def way(self, start: int, goal: int) -> FloatArray:
        """The shortest way (M, 6) over the net between two connected configurations."""
        _, before = dijkstra(self._net, False, np.array(start), True)
        nodes = [goal]
        while nodes[-1] != start:
            nodes.append(int(before[nodes[-1]]))
        return self._joints_rad[nodes[::-1]]


def _neighbours(joints_rad: FloatArray, n_neighbours: int) -> IntArray:
    """Pairs (E, 2) of configurations that are near to each other by their busiest joint."""
    k = min(n_neighbours + 1, len(joints_rad))
    near = np.asarray(KDTree(joints_rad).query(joints_rad, k=k, p=np.inf)[1]).reshape(len(joints_rad), k)
    pairs = np.stack([np.repeat(np.arange(len(joints_rad)), k), near.ravel()], axis=1)
    pairs = np.sort(pairs[pairs[:, 0] != pairs[:, 1]], axis=1)
    return np.unique(pairs, axis=0)


def clear_moves(
    scene: MotionScene, starts_rad: FloatArray, goals_rad: FloatArray, min_clearance_m: float
) -> BoolArray:
    """Which (E,) straight moves from (E, 6) to (E, 6) are clear, looked at every third degree."""
    clear = np.ones(len(starts_rad), dtype=bool)
    for k in range(0, len(starts_rad), _BATCH):
        ends = zip(starts_rad[k : k + _BATCH], goals_rad[k : k + _BATCH], strict=True)
        moves = [sample_move(start, goal, _COARSE_STEP_RAD) for start, goal in ends]
        near = scene.clearance(np.concatenate(moves)).distance_m < min_clearance_m
        first = np.cumsum([0] + [len(move) for move in moves[:-1]])
        clear[k : k + _BATCH] = ~np.logical_or.reduceat(near, first)
    return clear
