"""The JSON files of a session: which keys each must have, and of which kind."""

from __future__ import annotations

from datetime import datetime
from typing import Annotated, Any

from pydantic import AfterValidator, ConfigDict, Field, FiniteFloat, with_config
from typing_extensions import NotRequired, TypedDict

Count = Annotated[int, Field(ge=0, le=1_000_000_000)]
Index = Annotated[int, Field(ge=0, le=1_000)]
Share = Annotated[float, Field(ge=0, le=1)]
Seconds = Annotated[float, Field(ge=0, le=1e9)]
Vector = tuple[FiniteFloat, FiniteFloat, FiniteFloat]
Matrix3 = tuple[Vector, Vector, Vector]
_Row4 = tuple[FiniteFloat, FiniteFloat, FiniteFloat, FiniteFloat]
Matrix4 = tuple[_Row4, _Row4, _Row4, _Row4]


def _checked_time(text: str) -> str:
    datetime.fromisoformat(text)
    return text


Time = Annotated[str, AfterValidator(_checked_time)]
"""ISO 8601."""


class Record(TypedDict):
    """`record.json` of any stage."""

    stage: str
    inputs: dict[str, str]
    parameters: dict[str, Any]
    digest: str
    files: dict[str, Count]
    versions: dict[str, str]
    created: str
    seconds: Seconds


class Warnings(TypedDict):
    """`warnings.json` of any stage."""

    warnings: list[str]


class TableInView(TypedDict):
    """The table as one view sees it."""

    name: str
    height_m: FiniteFloat | None
    tilt_rad: FiniteFloat | None


class Correction(TypedDict):
    """What one view's pose was changed by."""

    name: str
    shift_m: FiniteFloat
    turn_rad: FiniteFloat
    residual_before_m: FiniteFloat | None
    residual_after_m: FiniteFloat | None
    T_base_camera: Matrix4


class Corrections(TypedDict):
    """What all poses were changed by."""

    views: list[Correction]
    residual_before_m: FiniteFloat | None
    residual_after_m: FiniteFloat | None
    table_sd_before_m: FiniteFloat | None
    table_sd_after_m: FiniteFloat | None
    view_error_m: FiniteFloat | None


class Reconstruction(TypedDict):
    """`reconstruction/result.json`."""

    platform_height_m: FiniteFloat
    truncation_m: FiniteFloat
    pose_health: list[TableInView]
    refinement: Corrections | None


class Unseen(TypedDict):
    """`unseen.json`."""

    unseen_ml: FiniteFloat


class View(TypedDict):
    """How good one view is."""

    name: str
    valid_share: FiniteFloat
    is_repeated: NotRequired[bool]
    table_height_m: NotRequired[FiniteFloat | None]
    table_tilt_rad: NotRequired[FiniteFloat | None]
    table_offset_m: NotRequired[FiniteFloat | None]
    residual_median_m: NotRequired[FiniteFloat | None]
    residual_rms_m: NotRequired[FiniteFloat | None]


class Cavity(TypedDict):
    """What no view saw inside the openings."""

    area_m2: NotRequired[FiniteFloat]
    volume_ml: NotRequired[FiniteFloat]
    depth_m: NotRequired[FiniteFloat]
    width_m: NotRequired[FiniteFloat]


class Quality(TypedDict):
    """`quality/quality.json`."""

    verdict: str
    reasons: list[str]
    unseen_share: FiniteFloat
    cavity: Cavity
    views: list[View]


class Collision(TypedDict):
    """`collision.json`."""

    method: str
    surface_error_m: NotRequired[FiniteFloat]


class Footprint(TypedDict):
    """Where the candies fell from that stayed."""

    center_m: Vector
    axis_rad: FiniteFloat
    deviations_m: tuple[FiniteFloat, FiniteFloat]


class Verdict(TypedDict):
    """What an object holds, held against its own size."""

    capacity_share: FiniteFloat
    threshold: FiniteFloat
    n_candies: FiniteFloat
    volume_ml: FiniteFloat
    level_candies: NotRequired[FiniteFloat | None]
    level_ml: NotRequired[FiniteFloat | None]
    has_stand_ins: NotRequired[bool]
    unseen_ml: NotRequired[FiniteFloat]
    other_share: NotRequired[FiniteFloat | None]
    least_ml: NotRequired[FiniteFloat | None]
    most_ml: NotRequired[FiniteFloat | None]
    too_small_m: NotRequired[FiniteFloat | None]


class Drop(TypedDict):
    """`containability/containability.json`; earlier versions kept the verdict in it."""

    omega: Share
    n_drop: Annotated[Count, Field(ge=1)]
    n_in: Count
    aabb_m: tuple[Vector, Vector]
    footprint: Footprint | None
    omega_threshold: NotRequired[FiniteFloat]
    verdict: NotRequired[Verdict | None]


class Judgement(TypedDict):
    """`judgement/judgement.json`."""

    omega_threshold: FiniteFloat
    verdict: Verdict | None


class Capacity(TypedDict):
    """`capacity.json`."""

    n_candies: FiniteFloat
    spread: FiniteFloat
    volume_ml: FiniteFloat
    heaped_ml: FiniteFloat
    geometric_volume_ml: FiniteFloat
    candy_hollow_ml: FiniteFloat
    candy_scale: FiniteFloat
    n_poured: list[Count]
    n_full: list[FiniteFloat]
    n_kept: list[FiniteFloat]
    rim_height_m: FiniteFloat
    fill_height_m: FiniteFloat
    explanation: str
    candies_per_ml: Annotated[FiniteFloat, Field(gt=0)]
    stand_in_diameter_m: NotRequired[FiniteFloat | None]
    least_ml: NotRequired[FiniteFloat | None]
    most_ml: NotRequired[FiniteFloat | None]
    unseen_ml: NotRequired[FiniteFloat]
    is_hollow_told: NotRequired[bool]
    hidden_ml: NotRequired[FiniteFloat]
    is_thin: NotRequired[bool]
    too_small_m: NotRequired[FiniteFloat | None]


class Holding(TypedDict):
    """`holding.json`, as far as it is read."""

    n_asked: Annotated[Count, Field(ge=1)]
    n_load: Count


class Amount(TypedDict):
    """How many candies go into the object."""

    request: str
    n_fit: Count
    n_safe: Count
    n_total: Count
    n_per_cup: list[Annotated[Count, Field(ge=1)]]
    fill_share: FiniteFloat
    fill_height_m: FiniteFloat
    share_of_capacity: FiniteFloat
    warning: str
    refusal: str


class PlannedAmount(TypedDict):
    """`amount/amount.json`."""

    n_pour: Count
    amount: Amount | None


class Pours(TypedDict):
    """`pouring/pours.json`."""

    n_pour: Annotated[Count, Field(ge=1)]
    n_cups: NotRequired[Annotated[Count, Field(ge=1)]]
    p: list[list[FiniteFloat]]
    p_spread: NotRequired[list[list[FiniteFloat]]]
    n_in: list[list[list[Count]]]
    n_spilled: NotRequired[list[list[list[Count]]]]
    theta_rad: list[FiniteFloat]
    indent_m: list[FiniteFloat]
    pivot_m: list[list[Vector]]


class FewerCandies(TypedDict):
    """A smaller amount that is sure enough."""

    n_candies: Annotated[Count, Field(ge=1)]
    i: Count
    j: Count
    n_tries: Annotated[Count, Field(ge=1)]
    n_clean: Count


class Risk(TypedDict):
    """`risk.json`, as far as it is read."""

    n_pour: Annotated[Count, Field(ge=1)]
    n_cups: NotRequired[Annotated[Count, Field(ge=1)]]
    spilled: list[list[list[Count]]]
    fewer: NotRequired[FewerCandies | None]


class PourChoice(TypedDict):
    """The pour to make."""

    i: Index
    j: Index
    theta_rad: FiniteFloat
    pivot_m: Vector
    t_init_m: Vector
    r_init: Matrix3


class Choice(TypedDict):
    """`choice.json`."""

    choice: PourChoice | None


class Feasibility(TypedDict):
    """Whether the arm can make a pour."""

    i: Index
    j: Index
    is_feasible: bool
    reason: str
    clearance_m: FiniteFloat
    turn_s: FiniteFloat
    duration_s: FiniteFloat


class Motions(TypedDict):
    """`motion/motion.json`; `paper_choice` is the former name of `free_choice`."""

    pours: list[Feasibility]
    choice: PourChoice | None
    free_choice: NotRequired[PourChoice]
    paper_choice: NotRequired[PourChoice]


class Evidence(TypedDict):
    """`evidence/evidence.json`; its files lie beside it."""

    renderer: str
    files: list[Annotated[str, Field(pattern=r"^[A-Za-z0-9_][A-Za-z0-9_.-]*$")]]


class Move(TypedDict):
    """One move of a plan."""

    name: str
    phase: str
    duration_s: FiniteFloat
    holds_cup: bool
    gripper_after: str | None


class Plan(TypedDict):
    """`plan.json` of a run."""

    i: Index
    j: Index
    clearance_m: FiniteFloat
    cup_clearance_m: FiniteFloat
    pivot_error_m: FiniteFloat
    singularity: FiniteFloat
    imagined_turn_s: FiniteFloat
    turn_s: FiniteFloat
    nearest: tuple[str, str]
    moves: Annotated[list[Move], Field(min_length=1)]
    digest: str


class Outcome(TypedDict):
    """`outcome.json` of a run."""

    n_candies: Count | None
    n_spilled: Count | None
    remarks: str
    is_simulated: bool
    facts: dict[str, Any]


class TableOutcome(TypedDict):
    """`table/outcome.json` of a simulated run, as far as it is read."""

    T_given_stood: Matrix4


@with_config(ConfigDict(extra="forbid"))
class OperatorChoice(TypedDict):
    """`operator_choice.json`: what a person decided is never passed over, so it holds nothing unknown."""

    i: Index
    j: Index
    reason: str
    imagination: str
    time: str


class Event(TypedDict):
    """One line of a run's `events.jsonl`, as far as it is read."""

    kind: str
    time: NotRequired[Time]
    sentence: NotRequired[str]
    imagination: NotRequired[str]
    note: NotRequired[str]
    is_back_off: NotRequired[bool]
