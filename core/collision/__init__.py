"""From a surface to a body for the physics: the surface itself, or convex parts (Sec. IV-C)."""

from core.collision.build import build_collision_model, from_parts, read_collision_model
from core.collision.model import CollisionModel
from core.collision.simplification import simplify, simplify_finely

__all__ = [
    "CollisionModel",
    "build_collision_model",
    "from_parts",
    "read_collision_model",
    "simplify",
    "simplify_finely",
]
