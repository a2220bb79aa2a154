"""All parameters of the method, with units, ranges and sources; presets; settings given as text.

One schema feeds the command line, the parameter editor and the documentation.
"""

from core.parameters.model import Parameters
from core.parameters.settings import (
    PRESET_NAMES,
    FieldFacts,
    apply_settings,
    describe,
    difference,
    flatten,
    load_preset,
)

__all__ = [
    "PRESET_NAMES",
    "FieldFacts",
    "Parameters",
    "apply_settings",
    "describe",
    "difference",
    "flatten",
    "load_preset",
]
