"""The verdict on an object: by what it holds (decision 0015), or by Omega alone (Sec. III-A)."""

from __future__ import annotations

from contextlib import suppress
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any

from core.collision import CollisionModel
from core.errors import StageError
from core.files import read_json, write_json
from core.imagination.capacity.finding import find_ahead
from core.imagination.capacity.imagine import hull_share, imagine_capacity, with_hidden
from core.imagination.capacity.result import CAPACITY_FILE, Capacity
from core.imagination.context import ImaginationContext
from core.imagination.drop import drop_task, imagine_drop
from core.imagination.results import Containability, Drop
from core.imagination.verdict import Verdict

JUDGEMENT_FILE = "judgement.json"


@dataclass(frozen=True)
class Judgement:
    """What follows from the drop.

    Attributes:
        omega_threshold: Omega_thr that Omega is held against.
        verdict: by what the object holds; none if Omega decides.
        capacity: none if Omega decides, or nothing stayed in the drop.
    """

    omega_threshold: float
    verdict: Verdict | None = None
    capacity: Capacity | None = None

    def of(self, drop: Drop) -> Containability:
        """Return the drop that was judged, with the verdict."""
        return drop.judged(self.omega_threshold, self.verdict)

    def save(self, folder: Path) -> None:
        """Write `judgement.json`, and the files of the capacity if it was imagined."""
        verdict = None if self.verdict is None else self.verdict.to_table()
        write_json(folder / JUDGEMENT_FILE, {"omega_threshold": self.omega_threshold, "verdict": verdict})
        if self.capacity is not None:
            self.capacity.save(folder)

    @classmethod
    def load(cls, folder: Path) -> Judgement:
        """Read what `save` wrote."""
        return cls.from_table(read_json(folder / JUDGEMENT_FILE), folder)

    @classmethod
    def from_table(cls, table: dict[str, Any], folder: Path) -> Judgement:
        """Read a table with threshold and verdict, and the files beside it."""
        verdict, is_filled = table.get("verdict"), (folder / CAPACITY_FILE).is_file()
        return cls(
            table["omega_threshold"],
            None if verdict is None else Verdict.from_table(verdict),
            Capacity.load(folder) if is_filled else None,
        )


def judge(context: ImaginationContext, model: CollisionModel, drop: Drop) -> Judgement:
    """Find what an object holds, if that decides and any candy stayed in the drop."""
    settings = context.parameters.containability
    if settings.verdict == "omega":
        return Judgement(settings.omega_threshold)
    if drop.footprint is None:
        nothing = Verdict(0.0, settings.capacity_threshold, 0.0, 0.0)
        return Judgement(settings.omega_threshold, _read_otherwise(context, model, nothing))
    capacity = imagine_capacity(context, model, drop)
    verdict = Verdict(
        hull_share(model.surface, capacity.bulk_ml),
        settings.capacity_threshold,
        capacity.n_candies,
        float(capacity.bulk_ml),
        capacity.level_candies,
        capacity.level_ml,
        capacity.stand_in_diameter_m is not None,
        least_ml=capacity.least_ml,
        most_ml=capacity.most_ml,
        too_small_m=capacity.too_small_m,
    )
    verdict = _read_otherwise(context, model, verdict)
    if verdict.is_container or verdict.is_undecided:
        capacity = with_hidden(context, model, capacity)
        verdict = replace(verdict, level_candies=capacity.level_candies, level_ml=capacity.level_ml)
    return Judgement(settings.omega_threshold, verdict, capacity)


def judge_ahead(context: ImaginationContext, model: CollisionModel) -> None:
    """Let processors that the drop leaves idle begin with what the verdict may ask for.

    Most objects of which nobody saw the bottom are containers if it is closed; then the leaking reading is
    asked about.
    """
    leaky, parameters = None if model.unseen is None else model.unseen.leaky, context.parameters
    if parameters.containability.verdict == "omega" or context.runner.workers == 1:
        return
    find_ahead(context, model)
    if leaky is None:
        return
    with suppress(StageError):  # smaller than a candy: the verdict says so if it comes to that
        task = drop_task(context, CollisionModel.exact(leaky))
        context.spare.append((task, partial(context.ahead.keep, leaky, parameters)))


def _read_otherwise(context: ImaginationContext, model: CollisionModel, verdict: Verdict) -> Verdict:
    """Imagine what the unseen may be otherwise, where that could change the answer.

    The verdict is that of the surface with the unseen solid: more room can only make it a container, and a
    hole in its bottom only none.
    """
    unseen = model.unseen
    other = None if unseen is None else unseen.leaky if verdict.is_container else unseen.roomy
    if unseen is None or other is None:
        return verdict
    body = CollisionModel.exact(other)
    drop = context.ahead.of(other, context.parameters) or imagine_drop(context, body)
    share = capacity_share(context, body, drop)
    return replace(verdict, unseen_ml=unseen.unseen_ml, other_share=share)


def capacity_share(context: ImaginationContext, model: CollisionModel, drop: Drop) -> float:
    """Return the `capacity_share` of the verdict that `judge` reaches."""
    if drop.footprint is None:
        return 0.0
    return hull_share(model.surface, imagine_capacity(context, model, drop).bulk_ml)
