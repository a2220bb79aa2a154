"""The NPZ files of a session: which arrays each must have, of which kind and shape."""

from __future__ import annotations

import re
from collections.abc import Mapping
from pathlib import Path

import numpy as np

from core.geometry import AnyArray

_Shape = tuple[int | str, ...]
_Spec = Mapping[str, tuple[str, _Shape]]
"""By the array's name: its kind ("float", "int" or "bool") and shape; equal letters are equal lengths."""

_RECORDING: _Spec = {
    "time_s": ("float", ("K",)),
    "position_steps": ("int", ("K", "N", 3)),
    "quaternion_steps": ("int", ("K", "N", 4)),
    "T_world_body": ("float", ("K", 4, 4)),
}
_DROP: _Spec = {"drop_positions_m": ("float", ("N", 3)), "retained": ("bool", ("N",)), **_RECORDING}
_CAPACITY: _Spec = {"heights_m": ("float", ("H",)), "volumes_ml": ("float", ("H",))}
_HOLLOWS: _Spec = {
    "hollow_origin_m": ("float", (2,)),
    "hollow_pitch_m": ("float", ()),
    "hollow_holds": ("bool", ("X", "Y")),
    "hollow_rim_m": ("float", ("X", "Y")),
    "hollow_floor_m": ("float", ("X", "Y")),
}
_OPEN_HOLLOWS: _Spec = {"hollow_is_open": ("bool", ("X", "Y"))}
"""Not in sessions of earlier versions."""
_HOLDING: _Spec = {
    "tilt_rad": ("float", ("S",)),
    "direction_rad": ("float", ("D",)),
    "n_left": ("int", ("D", "S")),
}
_COLLISION: _Spec = {
    "part_n_vertices": ("int", ("P",)),
    "part_n_faces": ("int", ("P",)),
    "part_vertices_m": ("float", ("V", 3)),
    "part_faces": ("int", ("F", 3)),
    "surface_vertices_m": ("float", ("W", 3)),
    "surface_faces": ("int", ("G", 3)),
}
_QUALITY: _Spec = {
    "n_views": ("int", ("V",)),
    "frontier_m": ("float", ("N", 3)),
    "region": ("int", ("M", 3)),
}
_COLORS: _Spec = {"rgb": ("int", ("V", 3))}
_TABLE: _Spec = {
    "in_object": ("bool", ("N",)),
    "in_cup": ("bool", ("N",)),
    "positions_m": ("float", ("N", 3)),
    "scales": ("float", ("N",)),
    **_RECORDING,
}
_SPECS: Mapping[tuple[str, str], _Spec] = {
    ("containability", "drop.npz"): _DROP,
    ("containability", "capacity.npz"): _CAPACITY,
    ("containability", "holding.npz"): _HOLDING,
    ("judgement", "capacity.npz"): _CAPACITY,
    ("judgement", "holding.npz"): _HOLDING,
    ("retention", "holding.npz"): _HOLDING,
    ("collision", "collision.npz"): _COLLISION,
    ("mesh", "collision.npz"): _COLLISION,
    ("quality", "quality.npz"): _QUALITY,
    ("colors", "colors.npz"): _COLORS,
    ("pouring", "pours.npz"): {},
    ("table", "outcome.npz"): _TABLE,
}
"""By folder and name. `plan.npz` is not among them: the plan's digest covers it."""
_NOT_EMPTY = {"S", "P", "V", "F", "W", "G", "X", "Y"}
_KINDS = {"float": "fiu", "int": "iu", "bool": "b"}
_POUR = re.compile(r"(pour_\d+_\d+_).+")


def check_arrays(path: Path, arrays: Mapping[str, AnyArray]) -> None:
    """Hold the arrays of a session's file against what it must hold; of other files nothing is known.

    Raises:
        ValueError: an array is missing, of another kind or shape, or not finite; one short line says which.
    """
    spec = _SPECS.get((path.parent.name, path.name))
    if spec is None:
        return
    _check(arrays, spec)
    if path.name == "collision.npz":
        _check_faces(arrays)
    if path.name == "capacity.npz" and "time_s" in arrays:
        _check(arrays, _RECORDING)
    if path.name == "capacity.npz" and "hollow_pitch_m" in arrays:
        _check(arrays, {**_HOLLOWS, **_OPEN_HOLLOWS} if "hollow_is_open" in arrays else _HOLLOWS)
        if arrays["hollow_pitch_m"] <= 0:
            raise ValueError("the pitch of the hollows is not above zero")
    for prefix in sorted({match[1] for name in arrays if (match := _POUR.fullmatch(name))}):
        _check(arrays, {prefix + name: kind_and_shape for name, kind_and_shape in _RECORDING.items()})


def _check(arrays: Mapping[str, AnyArray], spec: _Spec) -> None:
    lengths: dict[str, int] = {}
    for name, (kind, shape) in spec.items():
        if name not in arrays:
            raise ValueError(f"the array {name} is missing")
        array = arrays[name]
        if array.dtype.kind not in _KINDS[kind]:
            raise ValueError(f"the array {name} is not of kind {kind}")
        if not _fits(array.shape, shape, lengths):
            raise ValueError(f"the array {name} has another shape than {shape}")
        if kind == "float" and not np.isfinite(array).all():
            raise ValueError(f"the array {name} holds NaN or infinity")


def _fits(found: tuple[int, ...], shape: _Shape, lengths: dict[str, int]) -> bool:
    """Whether a shape is as specified; letters that are new get their length."""
    if len(found) != len(shape):
        return False
    for length, wanted in zip(found, shape, strict=True):
        if isinstance(wanted, str) and wanted in _NOT_EMPTY and length == 0:
            return False
        if length != (lengths.setdefault(wanted, length) if isinstance(wanted, str) else wanted):
            return False
    return True


def _check_faces(arrays: Mapping[str, AnyArray]) -> None:
    """Faces name vertices of their own part, and the parts share out what there is."""
    n_vertices, n_faces = arrays["part_n_vertices"], arrays["part_n_faces"]
    faces, surface = arrays["part_faces"], arrays["surface_faces"]
    if min(n_vertices.min(), n_faces.min()) < 1:
        raise ValueError("a part is empty")
    if n_vertices.sum() != len(arrays["part_vertices_m"]) or n_faces.sum() != len(faces):
        raise ValueError("the parts are longer or shorter than their arrays")
    limits = np.repeat(n_vertices, n_faces)[:, None]
    if faces.min() < 0 or (faces >= limits).any():
        raise ValueError("a face of a part names a vertex that it does not have")
    if surface.min() < 0 or surface.max() >= len(arrays["surface_vertices_m"]):
        raise ValueError("a face of the surface names a vertex that it does not have")
