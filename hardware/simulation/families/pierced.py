"""Vessels with holes, and what is open at both ends."""

from __future__ import annotations

from dataclasses import replace
from math import pi, sqrt

import numpy as np

from core.geometry import rotation_y
from core.mesh import TriangleMesh
from core.mesh_topology import join
from hardware.simulation.families.forms import (
    Draw,
    profiled,
    revolved,
    slab,
    standing,
    straight,
    vessel,
)
from hardware.simulation.families.truth import Form, Gap, Hole, solid
from hardware.simulation.objects import arc, loft, turned

_NARROWEST_M, _WIDEST_M = 0.002, 0.04
"""Openings of sieves and baskets."""


def drain_pot(draw: Draw) -> Form:
    """A plant pot with a hole of 3 to 40 mm in its floor."""
    height, wall = draw.between(0.06, 0.25), draw.between(0.002, 0.006)
    rim = height * draw.between(0.45, 0.6)
    hole = draw.swept(0.003, min(0.04, rim))
    pot = vessel(straight(0.7 * rim, rim, height), wall, 1.5 * wall)
    through = revolved([(hole / 2, 1.5 * wall), (hole / 2, 0.0)])
    return replace(pot, through_m=through).form(hole=Hole(Gap(hole), is_drain=False))


def funnel(draw: Draw) -> Form:
    """A funnel on its spout, which is 3 to 40 mm wide."""
    spout, wall = draw.swept(0.003, 0.04), draw.between(0.001, 0.003)
    radius = max(draw.between(0.03, 0.1), spout)
    length, cone = draw.between(0.02, 0.06), radius * draw.between(0.8, 1.3)
    inner = [(radius, length + cone), (spout / 2, length), (spout / 2, 0.0)]
    aside = wall * sqrt((radius - spout / 2) ** 2 + cone**2) / cone
    outer = [(r + aside, z) for r, z in reversed(inner)]
    body = replace(profiled(outer, inner, wall), through_m=np.empty((0, *revolved(inner[:1]).shape[1:])))
    return body.form(mouth_m=2 * radius, hole=Hole(Gap(spout), is_drain=True))


def sieve(draw: Draw) -> Form:
    """A round sieve: a ring over a grid of bars, 2 to 40 mm apart."""
    opening, wall = draw.swept(_NARROWEST_M, _WIDEST_M), draw.between(0.002, 0.005)
    bar = draw.between(0.0015, 0.003)
    radius = max(draw.between(0.05, 0.13), 2 * (opening + bar))
    foot, depth = draw.between(0.005, 0.02), radius * draw.between(0.4, 1.0)
    floor = foot + bar
    outer = [(radius + wall, 0.0), (radius + wall, floor + depth)]
    ring = profiled(outer, [(radius, floor + depth), (radius, floor)], min(wall, bar))
    ring = replace(ring, through_m=revolved([(radius, 0.0)]))
    bars = _grid_in_circle(radius + wall / 2, opening, bar, foot)
    return ring.form(bars, hole=Hole(Gap(opening, "square"), is_drain=True))


def _grid_in_circle(radius_m: float, opening_m: float, bar_m: float, low_m: float) -> TriangleMesh:
    """Bars along x and y that reach to a circle, so far apart that squares are left between them."""
    pitch = opening_m + bar_m
    n = int(radius_m / pitch)
    bars = []
    for k in range(-n, n + 1):
        # A grid with its square in the middle and one with its crossing there are both a sieve.
        off = (k + 0.5) * pitch if n % 2 else k * pitch
        far = abs(off) + bar_m / 2
        if far < radius_m:
            half = sqrt(radius_m**2 - far**2)
            bars.append(slab((2 * half, bar_m, bar_m), (0, off, low_m)))
            bars.append(slab((bar_m, 2 * half, 0.9 * bar_m), (off, 0, low_m + 0.05 * bar_m)))
    return join(tuple(bars))


def basket(draw: Draw) -> Form:
    """A basket of bars, 2 to 40 mm apart, on short feet."""
    opening, bar = draw.swept(_NARROWEST_M, _WIDEST_M), draw.between(0.002, 0.004)
    pitch, foot = opening + bar, 0.01
    n_x, n_y, n_z = (
        max(round(draw.between(low, high) / pitch), 2)
        for low, high in ((0.12, 0.3), (0.1, 0.22), (0.05, 0.15))
    )
    length, width, height = (n * pitch + bar for n in (n_x, n_y, n_z))
    columns, rows = _places(n_x, pitch), _places(n_y, pitch)
    side_x, side_y = columns[-1], rows[-1]
    post, rod = (bar, bar, foot + height), 0.9 * bar
    bars = [slab(post, (x, y, 0)) for x in columns for y in (-side_y, side_y)]
    bars += [slab(post, (x, y, 0)) for x in (-side_x, side_x) for y in rows[1:-1]]
    for k in range(n_z + 1):
        low = foot + k * pitch
        bars += [slab((2 * side_x, rod, bar), (0, y, low)) for y in (-side_y, side_y)]
        bars += [slab((rod, 2 * side_y, bar), (x, 0, low)) for x in (-side_x, side_x)]
    bars += [slab((2 * side_x, rod, bar), (0, y, foot)) for y in rows[1:-1]]
    bars += [slab((rod, 2 * side_y, rod), (x, 0, foot + 0.05 * bar)) for x in columns[1:-1]]
    room = (length - 2 * bar) * (width - 2 * bar) * (height - bar)
    hole = Hole(Gap(opening, "square"), is_drain=True)
    return Form(join(tuple(bars)), room, height - bar, Gap(min(length, width) - 2 * bar), bar, hole)


def _places(n: int, pitch_m: float) -> list[float]:
    return [(k - n / 2) * pitch_m for k in range(n + 1)]


def tube(draw: Draw) -> Form:
    """A tube that is open at both ends, standing or lying, 3 to 45 cm long."""
    radius, length = draw.between(0.012, 0.07), draw.between(0.03, 0.45)
    wall = min(draw.between(0.001, 0.006), 0.3 * radius)
    corners = [(radius, 0.0), (radius, length), (radius - wall, length), (radius - wall, 0.0)]
    mesh = turned(corners, closed=True)
    if draw.happens(0.5):
        return solid(mesh, wall, "it is open below: what falls in lies on the table")
    lying = TriangleMesh(mesh.vertices_m @ rotation_y(pi / 2).T, mesh.faces)
    return solid(standing(lying), wall, "it lies on its side and is open at both ends")


def ring(draw: Draw) -> Form:
    """A round or a flat ring that lies on the table."""
    thick = draw.between(0.005, 0.03)
    radius = thick + draw.between(0.02, 0.12)
    if draw.happens(0.5):
        mesh = turned(arc((radius, thick / 2), thick / 2, -pi / 2, 3 * pi / 2, 33)[:-1], closed=True)
    else:
        inside = radius - thick
        corners = [(radius, 0.0), (radius, thick / 2), (inside, thick / 2), (inside, 0.0)]
        mesh = turned(corners, closed=True)
    return solid(mesh, thick / 2, "a ring holds nothing: its inside is the table")


def gear(draw: Draw) -> Form:
    """A gear that lies on the table, with gaps between its teeth and a bore."""
    radius, n_teeth = draw.between(0.02, 0.12), draw.count(8, 24)
    tooth, thick = 0.12 * radius, draw.between(0.005, 0.03)
    angles = np.linspace(0, 2 * np.pi, 8 * n_teeth, endpoint=False)
    outline = np.column_stack([np.cos(angles), np.sin(angles)])
    is_tooth = np.arange(len(angles)) % 8 < 4
    outside = outline * np.where(is_tooth, radius, radius - tooth)[:, None]
    bore = outline * radius * draw.between(0.15, 0.5)
    rings = [(outside, 0.0), (outside, thick), (bore, thick), (bore, 0.0)]
    mesh = loft([np.column_stack([at, np.full(len(at), z)]) for at, z in rings], closed=True)
    return solid(mesh, thick, "it is flat: its bore and the gaps between its teeth end on the table")
