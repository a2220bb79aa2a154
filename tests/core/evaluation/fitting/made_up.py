"""An object's score without physics: quick, and known where it is best."""

from __future__ import annotations

from math import log10

import numpy as np

from core.collision import CollisionModel
from core.errors import StageError
from core.evaluation.fitting.containability import FitCase
from core.mesh import TriangleMesh
from core.parameters import Parameters

ROTATION = "containability.rotation_rad"
FRICTION = "containability.contact.lateral_friction"
BEST_ROTATION_RAD, BEST_FRICTION = 0.2, 0.05
START = {ROTATION: 0.05, FRICTION: 0.5}


def cases(seeds=(0, 1, 2)):
    triangle = TriangleMesh(np.eye(3), np.array([[0, 1, 2]]))
    model = CollisionModel("exact", (triangle,), triangle)
    kinds = {"mug": True, "bowl": True, "can": False, "block": False}
    return [FitCase(name, kinds[name], seed, model) for name in kinds for seed in seeds]


def made_up_score(case: FitCase, parameters: Parameters) -> float:
    """Containers keep 0.8 at best and others 0.1 at least; each name and seed a little off."""
    settings = parameters.containability
    off = 2 * abs(settings.rotation_rad - BEST_ROTATION_RAD)
    off += 0.2 * abs(log10(settings.contact.lateral_friction / BEST_FRICTION))
    own = 0.01 * case.seed + 0.001 * len(case.name)
    return min(max(0.8 - off - own if case.is_container else 0.1 + off + own, 0.0), 1.0)


def refusing_score(case: FitCase, parameters: Parameters) -> float:
    """The mug is too small for the candies of anybody who shakes it strongly."""
    if case.name == "mug" and parameters.containability.rotation_rad > 0.1:
        raise StageError("It is too small.")
    return made_up_score(case, parameters)
