"""`scan.json`: what the cell knew of the place where the object stood, each figure optional.

`{"platform_height_m": z, "crop_min_m": [x, y, z], "crop_max_m": [x, y, z]}`, in the robot's base frame.
"""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import Any

from core.errors import InputError
from core.scan.model import CropBox

SMALLEST_EDGE_M = 0.01


def facts_text(platform_height_m: float | None, crop_box: CropBox | None) -> str:
    """Return what `read_facts` gives back; empty when nothing is known."""
    facts: dict[str, Any] = {}
    if platform_height_m is not None:
        facts["platform_height_m"] = platform_height_m
    if crop_box is not None:
        facts |= {"crop_min_m": crop_box.min_m, "crop_max_m": crop_box.max_m}
    return json.dumps(facts, allow_nan=False) + "\n" if facts else ""


def read_facts(path: Path) -> tuple[float | None, CropBox | None]:
    """Return the platform's height and the crop box; a missing file knows neither.

    Raises:
        InputError: the file is damaged; the sentence names it.
    """
    if not path.exists():
        return None, None
    try:
        facts = dict(json.loads(path.read_text(encoding="utf-8")).items())
    except (OSError, ValueError, AttributeError, RecursionError) as error:
        raise InputError(f"{path} cannot be read ({error}); correct it or delete it.") from error
    return _platform_height(facts.get("platform_height_m"), path), _crop_box(facts, path)


def _platform_height(height: Any, path: Path) -> float | None:
    if height is None:
        return None
    if not _is_length(height):
        raise InputError(f"platform_height_m in {path} must be a height in metres in the base frame.")
    return float(height)


def _crop_box(facts: dict[str, Any], path: Path) -> CropBox | None:
    if facts.get("crop_min_m") is None and facts.get("crop_max_m") is None:
        return None
    low, high = _corner(facts.get("crop_min_m"), path), _corner(facts.get("crop_max_m"), path)
    if any(b - a < SMALLEST_EDGE_M for a, b in zip(low, high, strict=True)):
        raise InputError(
            f"crop_max_m in {path} must exceed crop_min_m by at least {SMALLEST_EDGE_M} m in every direction."
        )
    return CropBox(low, high)


def _corner(value: Any, path: Path) -> tuple[float, float, float]:
    if not (isinstance(value, list) and len(value) == 3 and all(_is_length(number) for number in value)):
        raise InputError(f"crop_min_m and crop_max_m in {path} must be three metres each in the base frame.")
    return float(value[0]), float(value[1]), float(value[2])


def _is_length(value: Any) -> bool:
    return not isinstance(value, bool) and isinstance(value, int | float) and math.isfinite(value)
