"""Closed bodies, lids, tableware with long handles, and things put together."""

from __future__ import annotations

import heapq
from math import pi

import numpy as np

from core.geometry import FloatArray, make_pose, rotation_x, transform_points
from core.mesh import TriangleMesh
from core.mesh_topology import join
from hardware.simulation.families.boxes import low_tray
from hardware.simulation.families.forms import (
    SUNK_M,
    Draw,
    curved,
    profiled,
    standing,
    vessel,
    volume_below_m3,
)
from hardware.simulation.families.truth import Form, Gap, solid
from hardware.simulation.families.vessels import bowl_outline, mug_body
from hardware.simulation.objects import Point, arc, bent_tube, boxed, loft, turned


def closed(draw: Draw) -> Form:
    """A closed body: a box, a ball, a cylinder or a bottle with its cap on."""
    size = draw.between(0.02, 0.15)
    tall = size * draw.between(0.6, 2.5)
    kind = draw.count(0, 3)
    if kind == 0:
        wide = size * draw.between(0.4, 1.0)
        mesh = boxed([(2 * size, 2 * wide, 0.0), (2 * size, 2 * wide, tall)], 0.1 * wide)
    elif kind == 1:
        mesh = turned(arc((0.0, size), size, -0.45 * pi, 0.5 * pi - 0.05, 40))
    elif kind == 2:
        mesh = turned([(size - 0.002, 0.0), (size, 0.002), (size, tall - 0.002), (size - 0.002, tall)])
    else:
        neck, low = 0.4 * size, 0.7 * (tall + size)
        body = curved([(size, 0.004), (size, 0.75 * low), (neck, low)])
        mesh = turned(
            [(0.9 * size, 0.0), *body, (1.15 * neck, low), (1.15 * neck, low + 0.02), (neck, low + 0.022)]
        )
    return solid(standing(mesh), float(mesh.extents_m.min()), "it is closed")


def can(draw: Draw) -> Form:
    """A closed can whose rim stands 1 to 10 mm above its lid."""
    radius, recess = draw.between(0.025, 0.08), draw.swept(0.001, 0.01)
    height, rim = max(radius * draw.between(0.8, 3.0), 4 * recess), draw.between(0.001, 0.002)
    outer = [(0.95 * radius, 0.0), (radius, 0.05 * radius), (radius, height)]
    inner = [(radius - rim, height), (radius - rim, height - recess)]
    return profiled(outer, inner, rim).form()


def lid(draw: Draw) -> Form:
    """A lid that lies on its back, its rim up by 2 to 30 mm, or as it closes a jar."""
    radius, wall, depth = draw.between(0.025, 0.09), draw.between(0.001, 0.003), draw.swept(0.002, 0.03)
    outer = [(radius, 0.0), (radius, depth + wall)]
    inner = [(radius - wall, depth + wall), (radius - wall, wall)]
    dish = profiled(outer, inner, wall)
    if draw.happens(0.7):
        return dish.form()
    flipped = TriangleMesh(dish.mesh.vertices_m @ rotation_x(pi).T, dish.mesh.faces)
    return solid(standing(flipped), wall, "its hollow opens downwards")


def spoon(draw: Draw) -> Form:
    """A spoon whose bowl is 3 to 25 mm deep."""
    radius, wall = draw.between(0.018, 0.035), draw.between(0.001, 0.002)
    height, longer = draw.swept(0.003, 0.025) + 1.5 * wall, draw.between(1.2, 1.6)
    body = vessel(bowl_outline(radius, height), wall, 1.5 * wall).stretched(longer)
    start, reach = longer * (radius - 0.5 * wall), draw.between(0.08, 0.15)
    corners = [(0.0, height - 0.0012), (0.2, height + 0.008), (0.6, height + 0.02), (1.0, height + 0.016)]
    path = [(start + share * reach, z) for share, z in corners]
    return body.form(bent_tube(_rounded(path), 0.005, 0.001))


def ladle(draw: Draw) -> Form:
    """A ladle with an upright handle."""
    radius, wall = draw.between(0.025, 0.06), draw.between(0.001, 0.002)
    height = radius * draw.between(0.5, 1.0)
    body = vessel(bowl_outline(radius, height), wall, 1.5 * wall)
    start, top = radius - 0.5 * wall, draw.between(0.1, 0.25)
    corners = [(start, height - 0.002), (start + 0.006, height + 0.01), (start + 0.012, height + 0.5 * top)]
    corners += [(start + 0.012, height + top), (start + 0.022, height + top + 0.01)]
    return body.form(bent_tube(_rounded(corners), 0.006, 0.001))


def _rounded(corners: list[Point]) -> FloatArray:
    """A smooth path (N, 2) through corners."""
    from scipy.interpolate import PchipInterpolator

    points = np.array(corners)
    along = np.concatenate([[0], np.cumsum(np.linalg.norm(np.diff(points, axis=0), axis=1))])
    path: FloatArray = PchipInterpolator(along, points)(np.linspace(0, along[-1], 40))
    return path


def blob(draw: Draw) -> Form:
    """A lump with a dent on top, which grows from nothing to half its radius, and dents elsewhere."""
    radius, n_rings, n_around = draw.between(0.03, 0.12), 64, 96
    polar = np.linspace(pi - 0.02, 0.02, n_rings)
    around = np.linspace(0, 2 * pi, n_around, endpoint=False)
    direction = np.stack(
        [
            np.sin(polar)[:, None] * np.cos(around),
            np.sin(polar)[:, None] * np.sin(around),
            np.repeat(np.cos(polar)[:, None], n_around, axis=1),
        ],
        axis=-1,
    )
    dents = [(np.array([0.0, 0.0, 1.0]), draw.swept(0.0, 0.75), draw.between(0.5, 0.9))]
    for _ in range(4):
        aside = np.append(draw.random.normal(size=2), 0.3 * draw.random.normal())
        dents.append((aside / np.linalg.norm(aside), draw.between(0.05, 0.2), draw.between(0.2, 0.4)))
    distance = np.full(direction.shape[:2], radius)
    for axis, deep, wide in dents:
        distance -= radius * deep * np.exp(-((np.arccos(np.clip(direction @ axis, -1, 1)) / wide) ** 2))
    points = direction * distance[..., None]
    points[..., 2] = np.maximum(points[..., 2], -0.8 * radius)
    mesh = standing(loft(points))
    bottom, level, room = pool(mesh, len(mesh.vertices_m) - 1)
    if room < 1e-9:
        return solid(mesh, 2 * radius, "it is a lump without a hollow on top")
    highest = points[..., 2].argmax(axis=0), np.arange(n_around)
    ridge = float(np.hypot(points[..., 0], points[..., 1])[highest].min())
    return Form(mesh, room, level - bottom, Gap(2 * ridge), 2 * radius * (1 - dents[0][1]))


def pool(mesh: TriangleMesh, start: int) -> tuple[float, float, float]:
    """Return bottom, level and volume of the water that a drop at a vertex would run to, exactly.

    The water rises from vertex to vertex until it finds one from which it runs off below its bottom.
    """
    heights = mesh.vertices_m[:, 2]
    ends = np.concatenate([np.roll(mesh.faces, k, axis=1)[:, :2] for k in range(3)])
    ends = ends[np.argsort(ends[:, 0], kind="stable")]
    first = np.searchsorted(ends[:, 0], np.arange(len(heights) + 1))
    neighbours = ends[:, 1]
    while heights[(around := neighbours[first[start] : first[start + 1]])].min() < heights[start]:
        start = int(around[heights[around].argmin()])
    level, wet, seen = heights[start], set(), {start}
    edge = [(heights[start], start)]
    while edge:
        height, vertex = heapq.heappop(edge)
        if height < heights[start]:
            break
        level = max(level, height)
        wet.add(vertex)
        for one in neighbours[first[vertex] : first[vertex + 1]].tolist():
            if one not in seen:
                seen.add(one)
                heapq.heappush(edge, (heights[one], one))
    is_wet = np.zeros(len(heights), dtype=np.bool_)
    is_wet[list(wet)] = True
    is_wet &= heights < level
    beneath = TriangleMesh(mesh.vertices_m, mesh.faces[is_wet[mesh.faces].any(axis=1)])
    return float(heights[start]), float(level), -volume_below_m3(beneath, float(level))


def mug_in_tray(draw: Draw) -> Form:
    """A mug in a tray: both hold candies, or the tray alone if the mug stands upside down."""
    mug, handle = mug_body(draw)
    tray = low_tray(draw, draw.swept(0.003, 0.04), 2.2 * float(np.ptp(mug.outer_m[..., 0])) + 0.05)
    is_upright = draw.happens(0.6)
    pose = make_pose(np.eye(3), [0, 0, tray.floor_m - SUNK_M])
    if not is_upright:
        pose = pose @ make_pose(rotation_x(pi), [0, 0, mug.rim_m])
    placed = mug.moved(pose)
    handle = TriangleMesh(transform_points(pose, handle.vertices_m), handle.faces)
    beside = tray.capacity_m3 - volume_below_m3(handle, tray.rim_m)
    beside -= placed.outer_volume_below_m3(tray.rim_m) - placed.outer_volume_below_m3(tray.floor_m)
    mesh = join((tray.mesh, placed.mesh, handle))
    walls = min(tray.wall_m, mug.wall_m)
    if is_upright:
        depth = mug.rim_m - mug.floor_m
        return Form(mesh, beside + mug.capacity_m3, depth, Gap(mug.mouth_m), walls)
    return Form(mesh, beside, tray.rim_m - tray.floor_m, Gap(tray.mouth_m), walls)
