"""Euclidean clusters of voxels."""

from __future__ import annotations

import numpy as np
from scipy.ndimage import label
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

from core.geometry import IntArray


def largest_cluster(indices: IntArray, gap_voxels: float) -> IntArray:
    """The largest set of voxels (N, 3) in which each is within `gap_voxels` of another, rows in their order.

    Neighbouring voxels are joined first, which leaves few groups to be measured against one another.
    """
    low = indices.min(axis=0)
    grid = np.zeros(indices.max(axis=0) - low + 1, dtype=np.bool_)
    grid[tuple((indices - low).T)] = True
    labels, n_groups = label(grid, structure=np.ones((3, 3, 3)))
    group_of_voxel = labels[tuple((indices - low).T)] - 1
    cluster_of_group = _join(indices, group_of_voxel, n_groups, gap_voxels)
    cluster_of_voxel = cluster_of_group[group_of_voxel]
    largest: IntArray = indices[cluster_of_voxel == np.bincount(cluster_of_voxel).argmax()]
    return largest


def _join(indices: IntArray, group_of_voxel: IntArray, n_groups: int, gap_voxels: float) -> IntArray:
    """Return the cluster (G,) of each group."""
    order = np.argsort(group_of_voxel, kind="stable")
    members = np.split(indices[order], np.cumsum(np.bincount(group_of_voxel, minlength=n_groups))[:-1])
    lows = np.array([group.min(axis=0) for group in members])
    highs = np.array([group.max(axis=0) for group in members])
    pairs: list[tuple[int, int]] = []
    for first, group in enumerate(members):
        overlap = (lows <= highs[first] + gap_voxels) & (highs >= lows[first] - gap_voxels)
        others = [int(other) for other in np.nonzero(overlap.all(axis=1))[0] if other > first]
        tree = cKDTree(group) if others else None
        for other in others:
            if tree is not None and np.min(tree.query(members[other])[0]) <= gap_voxels:
                pairs.append((first, other))
    ends = np.array(pairs, dtype=int).reshape(-1, 2)
    graph = coo_array((np.ones(len(ends), dtype=np.int8), (ends[:, 0], ends[:, 1])), (n_groups, n_groups))
    clusters: IntArray = connected_components(graph, directed=False)[1].astype(np.int64)
    return clusters
