"""Importing this loads all that a worker needs for its first task, the physics engine too."""

from core.imagination import pours
from core.imagination.engine import bullet

__all__ = ["READY", "pours"]

READY: int = bullet.DIRECT
