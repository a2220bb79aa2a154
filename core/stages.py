"""The one table of stages: what each is made from, and which parameters it reads.

Pipeline, window, command line, evaluation, library and documents take their lists from here. A stage gets the
parameters it reads and no others (`Stage.part`), so the table cannot lie; a parameter that no stage reads
counts as read by all of them, so a forgotten one makes results stale instead of wrong.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from functools import cache
from typing import Any, TypeVar

from core.parameters import Parameters, flatten
from core.parameters.part import part_of

P = TypeVar("P", bound=Parameters)

SCAN, MESH = "scan", "mesh"
GIVEN = (SCAN, MESH)
"""What comes from outside; a session holds one of the two."""
CAMERA_ERRORS = ("camera_error_m", "camera_error_rad")
"""In a scan's record: what the calibration of its camera leaves open of where an object is seen (SD)."""
SURFACE = "surface"
"""Stands for the stage that gives the object's surface: `mesh` if one was imported, else `reconstruction`."""


@dataclass(frozen=True)
class Stage:
    """One computed stage.

    Attributes:
        name: of the stage and of its folder in a session.
        inputs: the stages it is made from, `SURFACE` among them perhaps.
        reads: the parameters that decide its result, by dotted name; `group` is all of a group,
            `-group.name` is all of it but this one.
        of_scan: it exists only where there is a scan.
        needs_cell: it also depends on a cell, so that only a cell's owner can tell whether it is fresh.
    """

    name: str
    inputs: tuple[str, ...]
    reads: tuple[str, ...]
    of_scan: bool = False
    needs_cell: bool = False

    def inputs_of(self, source: str) -> tuple[str, ...]:
        """Return the stages it is made from if the surface comes from `source`."""
        return tuple(source if name == SURFACE else name for name in self.inputs)

    def parameter_names(self, parameters: Parameters) -> tuple[str, ...]:
        """Return the dotted names of the parameters it reads, in the schema's order."""
        return _names_read(self.reads, tuple(flatten(parameters)))

    def settings(self, parameters: Parameters) -> dict[str, Any]:
        """Return `{dotted name: value}` of what it reads: what its record keeps and freshness compares."""
        flat = flatten(parameters)
        return {name: flat[name] for name in _names_read(self.reads, tuple(flat))}

    def part(self, parameters: P) -> P:
        """Return what it reads of the parameters, and nothing else."""
        return part_of(parameters, self.parameter_names(parameters))


_PARTICLES = ("seed", "particle", "solver")
"""What every physical imagination reads."""
_BODY = ("collision.aabb_margin_m",)
_RECORDING = ("evidence.record_interval_s",)
_POUR = ("pouring", "-pouring.amount", "-pouring.n_pour")
"""How candies are poured; how many is the amount's business."""

STAGES: tuple[Stage, ...] = (
    Stage("reconstruction", (SCAN,), ("reconstruction",), of_scan=True),
    Stage(
        "quality",
        (SCAN, "reconstruction"),
        ("reconstruction.crop_min_m", "reconstruction.crop_max_m"),
        of_scan=True,
    ),
    Stage("colors", (SCAN, "reconstruction"), (), of_scan=True),
    Stage("collision", (SURFACE,), ("collision", "-collision.aabb_margin_m")),
    Stage(
        "containability",
        ("collision",),
        (
            *_PARTICLES,
            *_BODY,
            *_RECORDING,
            "containability",
            "-containability.verdict",
            "-containability.capacity_threshold",
            "-containability.omega_threshold",
        ),
    ),
    Stage(
        "judgement",
        (SURFACE, "collision", "containability"),
        (*_PARTICLES, *_BODY, *_RECORDING, "containability", "capacity"),
    ),
    Stage(
        "amount",
        ("judgement",),
        (
            "particle",
            "containability.verdict",
            "pouring.amount",
            "pouring.n_pour",
            "pouring.cup",
            "risk.candy_spread",
        ),
    ),
    Stage(
        "pouring",
        ("collision", "containability", "judgement", "amount"),
        (*_PARTICLES, *_BODY, *_RECORDING, *_POUR),
    ),
    Stage("risk", (SURFACE, "collision", "pouring"), (*_PARTICLES, *_BODY, *_RECORDING, *_POUR, "risk")),
    # Neither verdict nor pours wait for it.
    Stage(
        "retention",
        ("collision", "containability"),
        (
            *_PARTICLES,
            *_BODY,
            "containability",
            "-containability.capacity_threshold",
            "-containability.omega_threshold",
            "holding",
        ),
    ),
    Stage(
        "motion",
        (SURFACE, "collision", "containability", "pouring", "risk"),
        (*_PARTICLES, *_BODY, *_RECORDING, *_POUR, "risk"),
        needs_cell=True,
    ),
    Stage(
        "evidence",
        (SURFACE, "containability", "judgement", "pouring", "risk"),
        ("evidence", "particle", "containability", "pouring.cup", "pouring.counted"),
    ),
)
"""In the order of the work: none is made from a later one."""

STAGE_NAMES = (*GIVEN, *(stage.name for stage in STAGES))


def stage(name: str) -> Stage:
    """Return a computed stage by its name.

    Raises:
        KeyError: there is none.
    """
    return _BY_NAME[name]


def stages_of(source: str) -> tuple[Stage, ...]:
    """Return the computed stages of a session whose surface comes from `source`, in their order."""
    return tuple(one for one in STAGES if source != MESH or not one.of_scan)


def stages_before(name: str, source: str) -> tuple[str, ...]:
    """Return all stages that one is made from, directly or not, in the order of the work, itself last."""
    wanted = {name}
    for one in reversed(STAGES):
        if one.name in wanted:
            wanted.update(one.inputs_of(source))
    return tuple(known for known in STAGE_NAMES if known in wanted)


def stages_that_end_with(name: str) -> tuple[str, ...]:
    """Return the stages of whose inputs a stage is the last to be there."""
    return tuple(one.name for one in STAGES if one.inputs[-1] == name)


def groups_of(*names: str) -> tuple[str, ...]:
    """Return the groups of parameters that are any of some stages' own, in the schema's order.

    A group of which a stage reads single parameters is not its own.
    """
    entries = {entry for name in names for entry in _BY_NAME[name].reads}
    return tuple(field for field in Parameters.model_fields if field in entries)


def recorded_settings(name: str, recorded: Mapping[str, Any]) -> dict[str, Any]:
    """Return `{dotted name: value}` from a stage's record, also from one of an earlier version.

    Earlier versions kept nested groups, those of the stages with a group of their own name without its name.
    """
    flat = dict(_leaves(recorded))
    renamed = {"aabb_margin_m": "collision.aabb_margin_m", "record_interval_s": "evidence.record_interval_s"}
    known = set(flatten(Parameters()))

    def full_name(key: str) -> str:
        own = f"{name}.{key}"
        return key if key in known else renamed.get(key, own if own in known else key)

    return {full_name(key): value for key, value in flat.items()}


def changed_settings(name: str, recorded: Mapping[str, Any], parameters: Parameters) -> list[str]:
    """Return the dotted names of the parameters that differ from those a stage's record holds."""
    before = recorded_settings(name, recorded)
    now = _BY_NAME[name].settings(parameters)
    return [key for key, value in now.items() if key not in before or before[key] != _as_json(value)]


_BY_NAME: Mapping[str, Stage] = {one.name: one for one in STAGES}


def _reads(reads: Iterable[str], name: str) -> bool:
    """Whether a list of groups, names and exceptions covers a dotted name."""

    def covers(entry: str) -> bool:
        return name == entry or name.startswith(f"{entry}.")

    is_read = any(covers(entry) for entry in reads if not entry.startswith("-"))
    return is_read and not any(covers(entry[1:]) for entry in reads if entry.startswith("-"))


@cache
def _names_read(reads: tuple[str, ...], known: tuple[str, ...]) -> tuple[str, ...]:
    unclaimed = _unclaimed(known)
    return tuple(name for name in known if name in unclaimed or _reads(reads, name))


@cache
def _unclaimed(known: tuple[str, ...]) -> frozenset[str]:
    """The parameters that no stage reads."""
    return frozenset(name for name in known if not any(_reads(one.reads, name) for one in STAGES))


def _leaves(table: Mapping[str, Any], prefix: str = "") -> list[tuple[str, Any]]:
    leaves: list[tuple[str, Any]] = []
    for name, value in table.items():
        if isinstance(value, Mapping):
            leaves += _leaves(value, f"{prefix}{name}.")
        else:
            leaves.append((prefix + name, value))
    return leaves


def _as_json(value: Any) -> Any:
    return list(value) if isinstance(value, tuple) else value
