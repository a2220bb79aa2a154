"""Round vessels that stand upright."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from math import pi

import numpy as np

from core.geometry import FloatArray, rotation_z
from core.mesh import TriangleMesh
from hardware.simulation.families.forms import (
    Draw,
    Hollow,
    curved,
    profiled,
    revolved,
    straight,
    vessel,
)
from hardware.simulation.families.truth import Form
from hardware.simulation.objects import Point, arc, bent_tube, turned


def cup(draw: Draw) -> Form:
    """A beaker, 3 to 30 cm tall."""
    return plain_cup(draw, 0.03, 0.3).form()


def plain_cup(draw: Draw, lowest_m: float, tallest_m: float) -> Hollow:
    """A cylinder or cone of a height in that range; its wall is 1 to 6 mm thick."""
    height = draw.between(lowest_m, tallest_m)
    rim = min(height * draw.between(0.3, 0.7), 0.12)
    foot = rim * draw.between(0.6, 1.0)
    wall = min(draw.between(0.001, 0.006), 0.2 * foot)
    return vessel(straight(foot, rim, height), wall, wall * draw.between(1.0, 2.0))


def mug(draw: Draw) -> Form:
    """A cylinder with a handle."""
    body, handle = mug_body(draw)
    return body.form(handle)


def mug_body(draw: Draw) -> tuple[Hollow, TriangleMesh]:
    """A mug, and its handle."""
    radius, wall = draw.between(0.03, 0.055), draw.between(0.002, 0.006)
    height = radius * draw.between(1.8, 2.8)
    outline = straight(radius, radius, height)
    handle = handle_on(outline, wall, (0.25 * height, 0.78 * height), draw.between(0.02, 0.035))
    return vessel(outline, wall, wall * draw.between(1.0, 2.0)), handle


def bowl(draw: Draw) -> Form:
    """A round bowl, 8 to 40 cm across."""
    radius = draw.between(0.04, 0.2)
    height = radius * draw.between(0.45, 1.0)
    wall = min(draw.between(0.001, 0.008), height / 8)
    return vessel(bowl_outline(radius, height), wall, 1.5 * wall).form()


def bowl_outline(radius_m: float, height_m: float) -> list[Point]:
    """Outline of a bowl."""
    corners = [(0.40, 0.0), (0.62, 0.10), (0.80, 0.31), (0.93, 0.62), (1.0, 1.0)]
    return curved([(radius_m * r, height_m * z) for r, z in corners])


def plate(draw: Draw) -> Form:
    """A plate whose rim grows from 1 to 45 mm above its middle."""
    radius, thick, depth = draw.between(0.07, 0.16), draw.between(0.003, 0.006), draw.swept(0.001, 0.045)
    middle = radius * draw.between(0.55, 0.75)
    outer = [(middle + 0.01 * radius, 0.0), (radius, depth)]
    inner = [(radius, depth + thick), (middle, thick)]
    run = radius - middle
    return profiled(outer, inner, thick * run / float(np.hypot(run, depth))).form()


def bottle(draw: Draw) -> Form:
    """An open bottle whose neck grows from 6 to 70 mm."""
    wall, mouth = draw.between(0.001, 0.003), draw.swept(0.006, 0.07)
    neck = mouth / 2 + wall
    body = max(draw.between(0.025, 0.05), 1.15 * neck)
    height = body * draw.between(4.0, 6.0)
    corners = [(body, 0.004), (body, 0.55 * height), (neck, 0.8 * height), (neck, height)]
    return vessel([(body - 0.003, 0.0), *curved(corners)], wall, 2 * wall).form()


def vase(draw: Draw) -> Form:
    """A vase with a belly, whose neck grows from 12 to 120 mm."""
    wall, mouth = draw.between(0.002, 0.006), draw.swept(0.012, 0.12)
    neck = mouth / 2 + wall
    belly = max(draw.between(0.04, 0.09), 1.2 * neck)
    height = belly * draw.between(2.5, 4.0)
    corners = [(0.6 * belly, 0.0), (0.8 * belly, 0.08), (belly, 0.35), (neck + 0.3 * (belly - neck), 0.7)]
    corners += [(neck, 0.88), (1.04 * neck, 1.0)]
    return vessel(curved([(r, z * height) for r, z in corners]), wall, 2 * wall).form()


def goblet(draw: Draw) -> Form:
    """A wine glass: a cup on a stem."""
    radius, wall = draw.between(0.025, 0.05), draw.between(0.001, 0.003)
    height, stem = radius * draw.between(1.8, 3.0), draw.between(0.02, 0.1)
    corners = [(0.005, 0.0), (0.65 * radius, 0.16), (0.98 * radius, 0.5), (0.85 * radius, 1.0)]
    outline = curved([(r, stem + z * height) for r, z in corners])
    upper = vessel(outline, wall, stem + 0.04 * height + wall)
    foot: list[Point] = [(0.75 * radius, 0.0), (0.75 * radius, 0.002), (0.008, 0.007), (0.005, 0.015)]
    return replace(upper, outer_m=np.concatenate([revolved(foot), upper.outer_m])).form()


def bucket(draw: Draw) -> Form:
    """A bucket with its bail up, 12 to 45 cm tall with it."""
    height, wall = draw.between(0.09, 0.3), draw.between(0.001, 0.004)
    rim = height * draw.between(0.4, 0.5)
    body = vessel(straight(0.75 * rim, rim, height), wall, 1.5 * wall)
    thick = max(wall, 0.0015)
    bow = arc((0.0, 0.0), 1.0, pi, 0.0, 33)
    bail = bent_tube([((rim + 0.7 * thick) * x, height + 0.45 * height * z) for x, z in bow], thick, thick)
    return body.form(bail)


def urn(draw: Draw) -> Form:
    """An urn with a belly, a short neck and two handles, 15 to 42 cm tall."""
    belly, wall = draw.between(0.06, 0.15), draw.between(0.003, 0.008)
    height = belly * draw.between(2.0, 2.8)
    neck = belly * draw.between(0.45, 0.75)
    corners = [(0.55 * belly, 0.0), (0.45 * belly, 0.06), (belly, 0.5), (neck, 0.85), (1.15 * neck, 1.0)]
    outline = curved([(r, z * height) for r, z in corners])
    handle = handle_on(outline, wall, (0.55 * height, 0.85 * height), 0.35 * belly)
    other = TriangleMesh(handle.vertices_m @ rotation_z(pi).T, handle.faces)
    return vessel(outline, wall, 1.5 * wall).form(handle, other)


def rough_pot(draw: Draw) -> Form:
    """A pot formed by hand: its walls are uneven by up to a millimetre or two, inside and outside."""
    height, wall = draw.between(0.05, 0.2), draw.between(0.003, 0.008)
    rim = height * draw.between(0.4, 0.8)
    corners = [(0.6 * rim, 0.0), (0.9 * rim, 0.3 * height), (rim * draw.between(0.9, 1.2), 0.65 * height)]
    smooth = vessel(curved([*corners, (rim, height)]), wall, 1.5 * wall)
    uneven = 0.25 * wall
    return replace(
        smooth,
        outer_m=_roughened(smooth.outer_m, uneven, draw.random),
        inner_m=_roughened(smooth.inner_m, uneven, draw.random),
        wall_m=wall - 2 * uneven,
    ).form()


def double_wall(draw: Draw) -> Form:
    """A cup with a closed void of 2 to 15 mm in its wall."""
    inner, skin, void = draw.between(0.02, 0.045), draw.between(0.001, 0.002), draw.between(0.002, 0.015)
    height, outer = inner * draw.between(2.0, 5.0), inner + 2 * skin + void
    body = profiled([(outer, 0.0), (outer, height)], [(inner, height), (inner, 2 * skin)], skin)
    low, high = 2 * skin, height - skin
    corners = [(outer - skin, low), (outer - skin, high), (inner + skin, high), (inner + skin, low)]
    lining = turned(corners, closed=True)
    return body.form(TriangleMesh(lining.vertices_m, lining.faces[:, ::-1]))


def handle_on(
    outline: Sequence[Point], wall_m: float, heights_m: tuple[float, float], reach_m: float
) -> TriangleMesh:
    """A handle from one height of a vessel's outline to another; both ends are within the wall."""
    radii, heights = np.array(outline).T
    ends = np.interp(heights_m, heights, radii) - wall_m / 2
    bow = np.array(arc((0.0, 0.0), 1.0, -pi / 2, pi / 2, 25))
    share = (bow[:, 1] + 1) / 2
    path = np.column_stack(
        [ends[0] + (ends[1] - ends[0]) * share + reach_m * bow[:, 0], np.interp(share, [0, 1], heights_m)]
    )
    # An end as wide as this is off a round wall's middle by no more than a third of its thickness.
    half_width = min(0.0065, float(np.sqrt(0.6 * ends.min() * wall_m)))
    return bent_tube(path, half_width, 0.7 * half_width)


def _roughened(rings_m: FloatArray, most_m: float, random: np.random.Generator) -> FloatArray:
    """Move points of rings (R, K, 3) about the z-axis by at most `most_m` in and out, in waves."""
    x, y, z = np.moveaxis(rings_m, -1, 0)
    angle, radius = np.arctan2(y, x), np.hypot(x, y)
    n_waves = 12
    waves = np.zeros_like(angle)
    for around in random.integers(2, 20, n_waves).tolist():
        phase, up = random.uniform(0, 2 * np.pi), random.uniform(-150, 150)
        waves += np.cos(around * angle + up * z + phase)
    moved = 1 + most_m * (waves / n_waves) / radius
    return np.stack([x * moved, y * moved, z], axis=-1)
