"""An arm with its tools as a layer: as it looks, see-through, or the shape that is kept clear of things."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Literal

import numpy as np
import numpy.typing as npt

from app.gui.views.scene.arm_mesh import CAP, DARK, TUBE, Piece, arm_pieces
from app.gui.views.scene.parts import Layer, Paint, Part, prepare_mesh
from app.gui.views.scene.shapes import capsule_mesh, merged
from core.motion.arm_models import ArmModel, Capsule, arm_shape
from core.motion.kinematics import link_poses

ArmLooks = Literal["solid", "ghost", "collision"]

_COLORS = (TUBE, CAP, DARK)
_GHOST, _COLLISION = 0.38, 0.3
"""Opacities."""
_GHOST_THICKER_M = 0.0015
"""Where both arms are at one place the ghost lies around the other, instead of flickering in it."""
_GLOSS = 0.12


class Arm:
    """A layer that shows an arm with its tools.

    Attributes:
        layer: to be drawn.
    """

    def __init__(self, model: ArmModel, tools: Sequence[Capsule], looks: ArmLooks) -> None:
        """Make an arm that is as it looks (`solid`), a see-through one, or its collision shape."""
        self._model = model
        pieces = _capsules(model, tools) if looks == "collision" else arm_pieces(model, tools)
        self._links = sorted({piece.link for piece in pieces})
        self.layer = Layer(
            tuple(_part([piece for piece in pieces if piece.link == link], looks) for link in self._links)
        )

    def move(self, joints_rad: npt.ArrayLike) -> None:
        """Bend the arm to joint angles (6,)."""
        poses = link_poses(self._model, np.asarray(joints_rad, dtype=float))
        for link, part in zip(self._links, self.layer.parts, strict=True):
            part.T_layer_part = poses[link]


def _capsules(model: ArmModel, tools: Sequence[Capsule]) -> list[Piece]:
    """The shape that motions are checked with."""
    capsules = arm_shape(model, tools).capsules
    return [Piece(c.link, "", capsule_mesh(c.start_m, c.end_m, c.radius_m)) for c in capsules]


def _part(pieces: Sequence[Piece], looks: ArmLooks) -> Part:
    """All pieces of one link as one surface: each part that is drawn takes time."""
    mesh = prepare_mesh(*merged([piece.shape for piece in pieces]))
    if looks == "ghost":
        vertices, paint = mesh.vertices_m + _GHOST_THICKER_M * mesh.normals, Paint(("ghost",), opacity=_GHOST)
    elif looks == "collision":
        vertices, paint = mesh.vertices_m, Paint(("accent",), opacity=_COLLISION)
    else:
        counts = [len(piece.shape[0]) for piece in pieces]
        which = np.repeat([_COLORS.index(piece.color) for piece in pieces], counts)
        vertices, paint = mesh.vertices_m, Paint(_COLORS, which=which.astype(np.uint8))
    placed = vertices.astype(np.float32)
    return Part("surface", placed, paint, mesh.normals, mesh.faces.ravel(), gloss=_GLOSS)
