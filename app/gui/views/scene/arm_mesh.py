"""What an arm of the UR family looks like: housings, tubes and caps, from the lengths of its drawing.

Made to be recognised, not to be measured: the shape that is kept clear of things is `arm_shape`'s capsules,
which enclose this one.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np

from app.gui.views.scene.shapes import Shape, box_mesh, capsule_mesh, rounded_cylinder
from core.geometry import FloatArray
from core.motion.arm_models import FLANGE_LINK, ArmModel, Capsule
from core.motion.pour.cell import GRIPPER

TUBE, CAP, DARK = "#bcc2cb", "#5b86a6", "#3b4049"
"""Aluminium, the caps' blue-grey, and what is made of plastic or steel; in every theme."""
_UPPER_ASIDE_M, _FORE_ASIDE_M = 0.136, 0.017
"""Of upper arm and forearm from the base's axis, along joint 2's axis."""
_SHOULDER_M, _ELBOW_M, _WRIST_M = 0.060, 0.054, 0.0425
"""Radii of the housings."""
_UPPER_TUBE_M, _FORE_TUBE_M = 0.049, 0.0375
_FLANGE_M = 0.0315
_CAP_M = 0.012
"""A cap's height."""
_X, _Y, _Z = np.eye(3)


class Piece(NamedTuple):
    """A part of an arm's looks: the frame that carries it, 0 (base) to 6 (flange), its colour and surface."""

    link: int
    color: str
    shape: Shape


def arm_pieces(arm: ArmModel, tools: Sequence[Capsule]) -> list[Piece]:
    """Return everything an arm with its tools shows; see `Piece`."""
    pieces = [*_base_and_shoulder(arm), *_upper_arm(arm), *_forearm(arm), *_wrists(arm)]
    for tool in tools:
        pieces += _gripper(tool) if tool.name == GRIPPER else _bar(tool)
    return pieces


def _housing(
    link: int, at_m: FloatArray, axis: FloatArray, ends_m: tuple[float, float], radius_m: float
) -> Piece:
    """A cylinder along an axis through a point, from one end to the other along it."""
    low, high = ends_m
    return Piece(link, TUBE, rounded_cylinder(at_m + low * axis, at_m + high * axis, radius_m, 0.004))


def _cap(link: int, at_m: FloatArray, outwards: FloatArray, radius_m: float) -> Piece:
    """A lid on a housing's end."""
    return Piece(link, CAP, rounded_cylinder(at_m, at_m + _CAP_M * outwards, 0.985 * radius_m, 0.009))


def _base_and_shoulder(arm: ArmModel) -> Iterator[Piece]:
    height, r = arm.d_m[0], _SHOULDER_M
    yield Piece(0, DARK, rounded_cylinder(0 * _Z, 0.012 * _Z, 0.0745, 0.003))
    yield _housing(0, 0 * _Z, _Z, (0.011, height - r + 0.004), 0.0715)
    yield _housing(1, 0 * _Z, _Y, (-r - 0.004 + 0.006, r * 0.9), r)  # the base's axis is its y
    yield _cap(1, 0.9 * r * _Y, _Y, r)
    yield _housing(1, 0 * _Z, _Z, (-0.01, _UPPER_ASIDE_M - r - 0.002), r)


def _upper_arm(arm: ArmModel) -> Iterator[Piece]:
    shoulder, aside, r = -arm.a_m[1] * _X, _UPPER_ASIDE_M, _SHOULDER_M
    yield _housing(2, shoulder, _Z, (aside - r, aside + 0.052), r)
    yield _cap(2, shoulder + (aside + 0.052) * _Z, _Z, r)
    yield Piece(2, TUBE, rounded_cylinder(shoulder + aside * _Z, aside * _Z, _UPPER_TUBE_M, 0.002))
    yield _housing(2, 0 * _Z, _Z, (aside - r, aside + 0.050), _ELBOW_M)
    yield _cap(2, (aside + 0.050) * _Z, _Z, _ELBOW_M)


def _forearm(arm: ArmModel) -> Iterator[Piece]:
    elbow, aside = -arm.a_m[2] * _X, _FORE_ASIDE_M
    back = aside - 0.045
    yield _housing(3, elbow, _Z, (back, _UPPER_ASIDE_M - _SHOULDER_M - 0.002), _ELBOW_M - 0.002)
    yield _cap(3, elbow + back * _Z, -_Z, _ELBOW_M - 0.002)
    yield Piece(3, TUBE, rounded_cylinder(elbow + aside * _Z, aside * _Z, _FORE_TUBE_M, 0.002))
    yield _housing(3, 0 * _Z, _Z, (back, arm.d_m[3] - _WRIST_M - 0.002), _WRIST_M)
    yield _cap(3, back * _Z, -_Z, _WRIST_M)


def _wrists(arm: ArmModel) -> Iterator[Piece]:
    d5, d6, r = arm.d_m[4], arm.d_m[5], _WRIST_M
    yield _housing(4, 0 * _Z, _Y, (-r, r), r)
    yield _cap(4, r * _Y, _Y, r)
    yield _housing(4, 0 * _Z, _Z, (0.0, d5 - r - 0.002), r)
    yield _housing(5, 0 * _Z, -_Y, (-r, r), r)
    yield _cap(5, -r * _Y, -_Y, r)
    yield _housing(5, 0 * _Z, _Z, (0.0, d6 - 0.034), r - 0.003)
    yield Piece(FLANGE_LINK, DARK, rounded_cylinder(-0.034 * _Z, 0 * _Z, _FLANGE_M, 0.002))


def _gripper(tool: Capsule) -> Iterator[Piece]:
    """A body and two fingers, as long as the capsule that stands for it."""
    start, end = np.array(tool.start_m), np.array(tool.end_m)
    length, r = float(end[2] - start[2]) + tool.radius_m, tool.radius_m
    palm = 0.6 * length
    yield Piece(tool.link, DARK, rounded_cylinder(start, start + palm * _Z, 0.8 * r, 0.006))
    for side in (-1, 1):
        low, high = side * 0.78 * r - 0.1 * r, side * 0.78 * r + 0.1 * r
        yield Piece(
            tool.link, TUBE, box_mesh((low, -0.25 * r, palm - 0.01), (high, 0.25 * r, start[2] + length))
        )
    yield Piece(tool.link, DARK, box_mesh((-0.9 * r, -0.3 * r, palm - 0.02), (0.9 * r, 0.3 * r, palm)))


def _bar(tool: Capsule) -> Iterator[Piece]:
    """A bar with round ends, as cameras are that see depth, held at the flange by a bracket."""
    start, end = np.array(tool.start_m), np.array(tool.end_m)
    yield Piece(tool.link, DARK, capsule_mesh(start, end, 0.72 * tool.radius_m))
    middle = (start + end) / 2
    foot = np.array([0.0, 0.0, -0.008])
    yield Piece(tool.link, DARK, rounded_cylinder(foot, middle, 0.009, 0.002))
