"""The arm as its capsules: built once, then only its links' poses change."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from app.gui.views.scene.parts import Layer, Paint, Part
from app.gui.views.scene.prepared import prepare_mesh
from app.gui.views.scene.shapes import capsule_mesh, merged
from core.motion.arm_models import ArmModel
from core.motion.arm_shape import FLANGE_LINK, Capsule, arm_shape
from core.motion.kinematics import link_poses

_GHOST_OPACITY = 0.38
_GHOST_THICKER_M = 0.0015
"""Where both arms are at one place the ghost lies around the other, instead of flickering in it."""


class Arm:
    """A layer that shows an arm with its tools; a ghost is see-through and of another colour.

    Attributes:
        layer: to be drawn.
    """

    def __init__(self, model: ArmModel, tools: Sequence[Capsule], is_ghost: bool) -> None:
        self._model = model
        capsules = arm_shape(model, tools).capsules
        paint = Paint(("ghost",), opacity=_GHOST_OPACITY) if is_ghost else Paint(("arm",))
        self._links = [link for link in range(FLANGE_LINK + 1) if any(c.link == link for c in capsules)]
        thicker_m = _GHOST_THICKER_M if is_ghost else 0.0
        parts = [_link([c for c in capsules if c.link == link], thicker_m, paint) for link in self._links]
        self.layer = Layer(tuple(parts))

    def move(self, joints_rad: npt.ArrayLike) -> None:
        """Bend the arm to joint angles (6,)."""
        poses = link_poses(self._model, np.asarray(joints_rad, dtype=float))
        for link, part in zip(self._links, self.layer.parts, strict=True):
            part.T_layer_part = poses[link]


def _link(capsules: Sequence[Capsule], thicker_m: float, paint: Paint) -> Part:
    """All capsules of one link as one surface, thicker than they are."""
    vertices, faces = merged([capsule_mesh(c.start_m, c.end_m, c.radius_m + thicker_m) for c in capsules])
    mesh = prepare_mesh(vertices, faces)
    return Part("surface", mesh.vertices_m, paint, mesh.normals, mesh.faces.ravel())
