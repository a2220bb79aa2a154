"""The JSON files of an evaluation's folder: which keys each must have, and of which kind."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Annotated, Any, Literal

from pydantic import AfterValidator, Field
from typing_extensions import NotRequired, TypedDict

from core.formats.tables import Count, Seconds

_LONGEST_NAME = 200
"""Bytes, of an object; seed, variant and ending come to it in the name of a trial's file."""


def _checked_name(text: str) -> str:
    if not text.isprintable() or "/" in text or len(text.encode()) > _LONGEST_NAME:
        raise ValueError("it cannot be in a file's name")
    return text


Name = Annotated[str, AfterValidator(_checked_name), Field(min_length=1)]
Variant = Annotated[Name, Field(max_length=30)]
Label = Literal["container", "non-container", "ambiguous"]
Seed = Annotated[int, Field(ge=0, le=2**32)]
Number = Annotated[float, Field(ge=-1e9, le=1e9)]
Share = Annotated[float, Field(ge=0, le=1)]


class EvaluatedObject(TypedDict):
    """An object as far as tables and pages need it."""

    name: Name
    label: Label
    category: NotRequired[str]
    is_restricted: NotRequired[bool]
    is_calibration: NotRequired[bool]
    sha256: NotRequired[str]
    n_container: NotRequired[Count]
    n_asked: NotRequired[Count]
    capacity_ml: NotRequired[Number | None]


class Evaluation(TypedDict):
    """`evaluation.json`."""

    objects: Annotated[list[EvaluatedObject], Field(min_length=1)]
    source: str
    seeds: Annotated[list[Seed], Field(min_length=1)]
    variants: Annotated[list[Variant], Field(min_length=1)]
    n_pours: Count
    preset: str
    parameters: dict[str, Any]
    versions: NotRequired[dict[str, str]]
    seconds: NotRequired[Seconds]
    workers: NotRequired[Count]
    truth: NotRequired[dict[str, Any]]
    worlds: NotRequired[Annotated[list[str], Field(min_length=1)]]


class Trial(TypedDict):
    """What was found of one object in one trial."""

    name: Name
    label: Label
    seed: Seed
    variant: Variant
    threshold: Number
    n_drop: NotRequired[Count]
    n_in: NotRequired[Count]
    capacity_share: NotRequired[Number | None]
    capacity_candies: NotRequired[Number | None]
    capacity_ml: NotRequired[Number | None]
    capacity_least_ml: NotRequired[Number | None]
    capacity_most_ml: NotRequired[Number | None]
    unseen_ml: NotRequired[Number | None]
    holds_rad: NotRequired[Number | None]
    p_chosen: NotRequired[Number | None]
    clean_at_least: NotRequired[Number | None]
    wanted_clean: NotRequired[Number | None]
    n_tries: NotRequired[Count]
    n_feasible: NotRequired[Count | None]
    choice: NotRequired[tuple[Count, Count] | None]
    theta_rad: NotRequired[Number | None]
    n_pour: NotRequired[Count]
    worlds: NotRequired[list[str]]
    spilled: NotRequired[list[Count]]
    in_cup: NotRequired[list[Count]]
    view_scores: NotRequired[dict[str, Share]]
    view: NotRequired[str | None]
    top_down: NotRequired[str | None]
    is_restricted: NotRequired[bool]
    seconds: NotRequired[dict[str, Seconds]]
    picture: NotRequired[str]
    problem: NotRequired[str]


class TrialFile(TypedDict):
    """`trials/NAME.SEED.VARIANT.json`."""

    key: str
    trial: Trial


def check_evaluation(table: Evaluation) -> None:
    """Refuse what is there twice, and people who said more than they were asked.

    Raises:
        ValueError: one short line says where.
    """
    names = [one["name"] for one in table["objects"]]
    lists: dict[str, Sequence[object]] = {
        "objects": names, "seeds": table["seeds"], "variants": table["variants"],
    }  # fmt: skip
    for key, values in lists.items():
        if len(set(values)) < len(values):
            raise ValueError(f"{key}: one is there twice")
    if any(one.get("n_container", 0) > one.get("n_asked", 0) for one in table["objects"]):
        raise ValueError("objects: n_container exceeds n_asked")


def check_trial(table: TrialFile) -> None:
    """Refuse counts that do not fit together; trials of one world may leave it out.

    Raises:
        ValueError: one short line says which.
    """
    trial = table["trial"]
    if trial.get("n_in", 0) > trial.get("n_drop", 0):
        raise ValueError("trial: n_in exceeds n_drop")
    n_pours = len(trial.get("spilled", ()))
    if any(len(trial.get(name, ())) not in (0, n_pours) for name in ("worlds", "in_cup")):  # type: ignore[arg-type]
        raise ValueError("trial: spilled, worlds and in_cup have not one length")
