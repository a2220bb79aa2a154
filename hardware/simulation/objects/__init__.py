"""Built-in objects, made by code: closed surfaces in metres that rest on z = 0, z up."""

from hardware.simulation.objects.catalogue import BUILTIN_OBJECTS, builtin_object

__all__ = ["BUILTIN_OBJECTS", "builtin_object"]
