"""An arm with its tools as a layer: as it looks, see-through, or the shape that is kept clear of things."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Literal

import numpy as np
import numpy.typing as npt

from app.gui.views.scene.arm_mesh import Piece, arm_pieces
from app.gui.views.scene.parts import Layer, Paint, Part, prepare_mesh
from app.gui.views.scene.shapes import Shape, capsule_mesh, merged
from core.motion.arm_models import ArmModel, Capsule, arm_shape
from core.motion.kinematics import link_poses

ArmLooks = Literal["solid", "ghost", "collision"]

_GHOST_OPACITY, _COLLISION_OPACITY = 0.38, 0.3
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
        paints = {
            "solid": None,
            "ghost": Paint(("ghost",), opacity=_GHOST_OPACITY),
            "collision": Paint(("accent",), opacity=_COLLISION_OPACITY),
        }
        groups: dict[tuple[int, str], list[Shape]] = {}
        for piece in pieces:
            color = piece.color if looks == "solid" else ""
            groups.setdefault((piece.link, color), []).append(piece.shape)
        self._links = [link for link, _ in groups]
        thicker_m = _GHOST_THICKER_M if looks == "ghost" else 0.0
        self.layer = Layer(
            tuple(
                _part(merged(shapes), paints[looks] or Paint((color,)), thicker_m)
                for (_, color), shapes in groups.items()
            )
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


def _part(shape: Shape, paint: Paint, thicker_m: float) -> Part:
    mesh = prepare_mesh(*shape)
    vertices = mesh.vertices_m + np.float32(thicker_m) * mesh.normals
    return Part("surface", vertices, paint, mesh.normals, mesh.faces.ravel(), gloss=_GLOSS)
