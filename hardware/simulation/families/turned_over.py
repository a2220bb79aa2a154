"""Vessels that do not stand as they are meant to."""

from __future__ import annotations

from dataclasses import replace
from math import cos, pi, radians

import numpy as np

from core.geometry import make_pose, rotation_x, rotation_y
from hardware.simulation.families.forms import (
    Draw,
    Hollow,
    profiled,
    revolved,
    standing,
    straight,
    vessel,
)
from hardware.simulation.families.truth import Form, Gap, solid
from hardware.simulation.families.vessels import bowl_outline, plain_cup


def upside_down(draw: Draw) -> Form:
    """A cup or bowl turned over; the hollow of its foot, now on top, is 0 to 9 mm deep."""
    radius, foot = draw.between(0.03, 0.1), draw.swept(0.0, 0.009)
    wall = draw.between(0.002, 0.006)
    height = max(radius * draw.between(0.6, 2.0), 4 * (foot + wall))
    outline = bowl_outline(radius, height) if draw.happens(0.5) else straight(0.8 * radius, radius, height)
    inside = outline[0][0] - max(wall, 0.1 * outline[0][0])
    cup = vessel(outline, wall, foot + wall)
    if foot < 0.0005:
        mesh = standing(_turned_over(cup).mesh)
        return solid(mesh, wall, "it stands upside down, and its foot is flat")
    recess = profiled([], [(inside, height), (inside, height - foot)], wall)
    cup = replace(cup, outer_m=np.concatenate([revolved([(inside, foot), (inside, 0.0)]), cup.outer_m]))
    mesh = standing(_turned_over(cup).mesh)
    return Form(mesh, recess.capacity_m3, foot, Gap(2 * inside), wall)


def _turned_over(cup: Hollow) -> Hollow:
    return cup.moved(make_pose(rotation_x(pi), np.zeros(3)))


def lying(draw: Draw) -> Form:
    """A cup or jar that lies on its side."""
    cup = plain_cup(draw, 0.05, 0.3)
    fallen = cup.moved(make_pose(rotation_y(pi / 2), np.zeros(3)))
    form = fallen.form(mouth_m=0.0)
    because = "it lies on its side: its mouth does not open upwards"
    return replace(form, mesh=standing(form.mesh), empty_because=because)


def tilted(draw: Draw) -> Form:
    """A cup that leans by 3 to 50 degrees, its foot cut level."""
    cup = plain_cup(draw, 0.06, 0.2)
    angle = radians(draw.swept(3, 50))
    leaning = cup.moved(make_pose(rotation_y(angle), np.zeros(3)))
    axis = rotation_y(angle)[:, 2]
    lowest = leaning.outer_m[1]
    down = (lowest[:, 2] - lowest[:, 2].min() + 0.001) / axis[2]
    outer = np.concatenate([[lowest - down[:, None] * axis], leaning.outer_m[1:]])
    form = replace(leaning, outer_m=outer).form(mouth_m=cup.mouth_m * cos(angle))
    return replace(form, mesh=standing(form.mesh))
