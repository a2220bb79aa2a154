"""`views.json` of a scan: from where it is taken, and what became of each view."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import Field, FiniteFloat
from typing_extensions import NotRequired, TypedDict

_Coordinate = Annotated[float, Field(ge=-10, le=10)]
_Point = tuple[_Coordinate, _Coordinate, _Coordinate]
_Joints = tuple[FiniteFloat, FiniteFloat, FiniteFloat, FiniteFloat, FiniteFloat, FiniteFloat]
_SMALLEST_EDGE_M = 0.001


class Box(TypedDict):
    """A box by its corners."""

    min_m: _Point
    max_m: _Point


class Plan(TypedDict):
    """From where the views are taken."""

    views_rad: list[_Joints]
    crop_box: Box
    keep_out: Box


class View(TypedDict):
    """One view, and what became of it."""

    name: Annotated[str, Field(pattern=r"^[A-Za-z0-9_-]{1,100}$")]
    joints_rad: _Joints
    state: Literal["pending", "taken", "poor", "failed"]
    problems: list[str]


class Views(TypedDict):
    """The whole file."""

    origin: NotRequired[dict[str, Any]]
    plan: NotRequired[Plan | None]
    views: list[View]


def check_views(table: Views) -> None:
    """Refuse two views of one name, and a box whose corners are exchanged.

    Raises:
        ValueError: one short line says where.
    """
    names = [view["name"] for view in table["views"]]
    if len(set(names)) < len(names):
        raise ValueError("views: two have one name")
    plan = table.get("plan")
    boxes = [] if plan is None else [plan["crop_box"], plan["keep_out"]]
    edges_m = [high - low for box in boxes for low, high in zip(box["min_m"], box["max_m"], strict=True)]
    if any(edge_m < _SMALLEST_EDGE_M for edge_m in edges_m):
        raise ValueError("plan: a box has no inside")
