"""The verdict on an object: by what it holds (decision 0015), or by Omega alone (Sec. III-A)."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from core.collision import CollisionModel
from core.files import read_json, write_json
from core.imagination.capacity.filled import fill_beside
from core.imagination.capacity.finding import find_ahead
from core.imagination.capacity.imagine import (
    enclosed_share,
    hull_share,
    imagine_capacity,
    imagine_filling,
    with_hidden,
)
from core.imagination.capacity.result import CAPACITY_FILE, Capacity
from core.imagination.context import ImaginationContext
from core.imagination.drop import imagine_drop
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
        return Judgement(settings.omega_threshold, _read_roomy(context, model, nothing))
    leaky = _leaky_body(model)
    if leaky is not None and context.runner.workers > 1:
        fill_beside(_filling_once(context), leaky, drop)
    capacity = imagine_capacity(context, model, drop)
    verdict = Verdict(
        enclosed_share(model.surface, capacity),
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
    if not verdict.is_container:
        verdict = _read_roomy(context, model, verdict)
    elif leaky is not None and model.unseen is not None:
        share = hull_share(leaky.surface, imagine_filling(_filling_once(context), leaky, drop).bulk_ml)
        verdict = replace(verdict, unseen_ml=model.unseen.unseen_ml, other_share=share)
    if verdict.is_container or verdict.is_undecided:
        capacity = with_hidden(context, model, capacity)
        verdict = replace(verdict, level_candies=capacity.level_candies, level_ml=capacity.level_ml)
    return Judgement(settings.omega_threshold, verdict, capacity)


def judge_ahead(context: ImaginationContext, model: CollisionModel) -> None:
    """Let processors that the drop leaves idle begin with what the verdict may ask for."""
    if context.parameters.containability.verdict != "omega" and context.runner.workers > 1:
        find_ahead(context, model)


def _leaky_body(model: CollisionModel) -> CollisionModel | None:
    """What a container is as well, as far as anybody saw: it may have a hole in its bottom.

    Most objects of which nobody saw the bottom are containers if it is closed. What rains into the hole is
    what stayed of the drop on the closed one. What stays of it counts even with no rim all around: whether
    there is a hole at all is not known.
    """
    leaky = None if model.unseen is None else model.unseen.leaky
    return None if leaky is None else CollisionModel.exact(leaky)


def _read_roomy(context: ImaginationContext, model: CollisionModel, verdict: Verdict) -> Verdict:
    """Imagine the unseen as room, which can make a container of what is none."""
    if model.unseen is None:
        return verdict
    body = CollisionModel.exact(model.unseen.roomy)
    share = capacity_share(_filling_once(context), body, imagine_drop(context, body))
    return replace(verdict, unseen_ml=model.unseen.unseen_ml, other_share=share)


def _filling_once(context: ImaginationContext) -> ImaginationContext:
    """Of another reading it is asked on which side of the threshold it lies, not what it holds."""
    parameters = context.parameters
    once = parameters.capacity.model_copy(update={"n_fillings": 1})
    return context.reading(parameters.model_copy(update={"capacity": once}))


def capacity_share(context: ImaginationContext, model: CollisionModel, drop: Drop) -> float:
    """Return the `capacity_share` of the verdict that `judge` reaches."""
    if drop.footprint is None:
        return 0.0
    return enclosed_share(model.surface, imagine_filling(context, model, drop))
