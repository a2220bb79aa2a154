"""Boxes, trays and blocks with hollows."""

from __future__ import annotations

from dataclasses import replace
from itertools import accumulate

import numpy as np

from hardware.simulation.families.forms import SUNK_M, Block, Draw, Hollow, slab, tub
from hardware.simulation.families.truth import Form, Gap


def open_box(draw: Draw) -> Form:
    """An open box, 4 to 40 cm long, with walls of 1 to 15 mm."""
    return _box(draw).form()


def _box(draw: Draw) -> Hollow:
    length = draw.between(0.05, 0.4)
    width, height = length * draw.between(0.5, 1.0), length * draw.between(0.3, 1.0)
    wall = min(draw.between(0.001, 0.015), 0.12 * width)
    corner = min(draw.between(0.002, 0.02), 0.2 * width)
    return tub((length, width, height), wall, wall, corner, lean_m=0.0)


def lidded_box(draw: Draw) -> Form:
    """A box with a lid on it that covers a quarter to all of it."""
    box = _box(draw)
    low, high = box.mesh.aabb_min_m, box.mesh.aabb_max_m
    length, width, _ = box.mesh.extents_m.tolist()
    covered = min(draw.swept(0.25, 1.1), 1.0)
    lid = slab((covered * length, width, 0.003), (low[0] + covered * length / 2, 0, high[2] - SUNK_M))
    inside = length - 2 * box.wall_m
    free = max(length * (1 - covered) - box.wall_m, 0.0)
    form = box.form(lid)
    if covered == 1:
        return replace(form, mouth=Gap(0.0), empty_because="its lid is on")
    return replace(form, mouth=Gap(min(free, box.mouth_m), "slot" if free < inside / 2 else "square"))


def tray(draw: Draw) -> Form:
    """A tray whose rim grows from 1 to 45 mm above its floor."""
    return low_tray(draw, draw.swept(0.001, 0.045)).form()


def low_tray(draw: Draw, depth_m: float, least_m: float = 0.15) -> Hollow:
    """A tray, at least so long, with leaning walls and a rim of that height above its floor."""
    length, wall = draw.between(least_m, 0.42), draw.between(0.002, 0.005)
    size = (length, length * draw.between(0.5, 0.8), depth_m + wall)
    return tub(size, wall, wall, 0.012, lean_m=0.4 * depth_m)


def broken_tray(draw: Draw) -> Form:
    """A tray with a notch in a long wall, which reaches down to the floor or less."""
    length, wall, floor = draw.between(0.15, 0.4), draw.between(0.004, 0.01), draw.between(0.003, 0.006)
    width, depth = length * draw.between(0.5, 0.8), draw.between(0.015, 0.06)
    notch, sill = draw.between(0.15, 0.6) * length, draw.swept(0.0, 0.9) * depth
    heights = np.full((5, 3), floor + depth)
    heights[1:-1, 1] = floor
    heights[2, 0] = floor + sill
    edges = np.array([0, wall, (length - notch) / 2, (length + notch) / 2, length - wall, length])
    block = Block.of_cells(edges, [0, wall, width - wall, width], heights)
    room = block.capacity_m3(floor + sill)
    return Form(block.mesh, room, sill, Gap(width - 2 * wall), min(wall, floor), breach_m=notch)


def compartments(draw: Draw) -> Form:
    """A box with compartments, the narrowest 8 to 80 mm wide; dividers are as high as the rim or lower."""
    n_x, n_y = draw.count(2, 5), draw.count(1, 3)
    narrow, wall = draw.swept(0.008, 0.08), draw.between(0.002, 0.006)
    long, depth = narrow * draw.between(1.0, 1.6), draw.between(0.02, 0.09)
    divider = wall + depth * min(draw.between(0.5, 1.3), 1.0)
    edges_x = _walls_and_rooms(n_x, wall, long if n_x < n_y else narrow)
    edges_y = _walls_and_rooms(n_y, wall, narrow if n_x < n_y else long)
    heights = np.full((2 * n_x + 1, 2 * n_y + 1), divider)
    heights[[0, -1]] = heights[:, [0, -1]] = wall + depth
    heights[1::2, 1::2] = wall
    block = Block.of_cells(edges_x, edges_y, heights)
    return Form(block.mesh, block.capacity_m3(wall + depth), depth, Gap(narrow, "square"), wall)


def _walls_and_rooms(n_rooms: int, wall_m: float, room_m: float) -> list[float]:
    """Edges of cells that are walls and rooms in turn."""
    widths = [wall_m if k % 2 == 0 else room_m for k in range(2 * n_rooms + 1)]
    return [0.0, *accumulate(widths)]


def muffin_tin(draw: Draw) -> Form:
    """A plate with round pockets, which grow from 2 to 40 mm deep."""
    n_x, n_y, radius = draw.count(2, 4), draw.count(1, 3), draw.between(0.018, 0.04)
    depth, floor = draw.swept(0.002, 0.04), draw.between(0.002, 0.005)
    pitch = 2.25 * radius
    xs, ys = (np.linspace(-n * pitch / 2, n * pitch / 2, 36 * n + 1) for n in (n_x, n_y))
    x, y = np.meshgrid(xs, ys, indexing="ij")
    off_x, off_y = ((at % pitch) - pitch / 2 for at in (x + n_x * pitch / 2, y + n_y * pitch / 2))
    share = np.hypot(off_x, off_y) / radius
    block = Block(xs, ys, floor + depth * np.clip(share, 0, 1) ** 4)
    return Form(block.mesh, block.capacity_m3(floor + depth), depth, Gap(2 * radius), floor)


def keyboard(draw: Draw) -> Form:
    """A keyboard in a frame as high as its keys; between these are gaps of 2 to 12 mm."""
    n_x, n_y, key = draw.count(8, 15), draw.count(4, 6), draw.between(0.013, 0.018)
    gap, base, rise = draw.swept(0.002, 0.012), draw.between(0.006, 0.015), draw.between(0.004, 0.01)
    edges = [_keys_and_gaps(n, gap, key) for n in (n_x, n_y)]
    heights = np.full((2 * n_x + 3, 2 * n_y + 3), base)
    heights[[0, -1]] = heights[:, [0, -1]] = base + rise
    heights[2:-1:2, 2:-1:2] = base + rise
    block = Block.of_cells(edges[0], edges[1], heights)
    return Form(block.mesh, block.capacity_m3(base + rise), rise, Gap(gap, "slot"), base)


def _keys_and_gaps(n_keys: int, gap_m: float, key_m: float) -> list[float]:
    """Edges of cells: the frame, gaps and keys in turn, and the frame again."""
    widths = [0.008, *([gap_m, key_m] * n_keys), gap_m, 0.008]
    return [0.0, *accumulate(widths)]
