"""All runs of the cup alone that an imagination needs: each is made once, or found where they are kept."""

from __future__ import annotations

import json
from collections.abc import Sequence
from functools import partial

from core.imagination.context import ImaginationContext
from core.imagination.cup_run import CupRun, packing_task
from core.imagination.kept_runs import KeptRuns
from core.imagination.set_up import SetUp, as_planned
from core.parameters import Parameters
from core.parameters.part import part_of
from core.workers import Task

CUP_STAGE = "cup"
_CUP_READS = (
    "seed",
    "particle",
    "solver",
    "pouring.n_pour",
    "pouring.gamma_0_rad",
    "pouring.settle_s",
    "pouring.turn_s",
    "pouring.wait_s",
    "pouring.cup",
    "pouring.contact",
    "evidence.record_interval_s",
)


class CupRuns:
    """Runs of the cup alone, made when first asked for: they know no object, so objects can share them."""

    def __init__(self, kept: KeptRuns | None = None) -> None:
        """Begin with what is kept from earlier sessions; none: nothing is, nor will be."""
        self._known: dict[str, CupRun] = {}
        self._kept = kept

    def of(self, context: ImaginationContext, set_ups: Sequence[SetUp]) -> list[CupRun]:
        """Return the run of each set-up.

        Raises:
            StageError: the cup cannot hold N_pour.
        """
        keys = [_settings_key(context.parameters, one) for one in set_ups]
        missing = {key: one for key, one in zip(keys, set_ups, strict=True) if not self._knows(key)}
        tasks = [_task(context, one) for one in missing.values()]
        if tasks:
            for key, run in zip(missing, context.run(tasks, CUP_STAGE), strict=True):
                self._take(key, run)
        return [self._known[key] for key in keys]

    def of_packings(self, context: ImaginationContext) -> list[CupRun]:
        """Return the runs that the pours need: none if cup and object are simulated together."""
        return self.of(context, planned_set_ups(context.parameters))

    def prepare(self, context: ImaginationContext) -> None:
        """Let the next imagination fill idle processors with the runs of `of_packings`."""
        for one in planned_set_ups(context.parameters):
            key = _settings_key(context.parameters, one)
            if not self._knows(key):
                context.spare.append((_task(context, one), partial(self._take, key)))

    def _knows(self, key: str) -> bool:
        if key not in self._known and self._kept is not None:
            found = self._kept.fetch(key)
            if found is not None:
                self._known[key] = found
        return key in self._known

    def _take(self, key: str, run: CupRun) -> None:
        self._known[key] = run
        if self._kept is not None:
            self._kept.store(key, run)


def planned_set_ups(parameters: Parameters) -> list[SetUp]:
    """Return the set-ups of the pours as planned: none if cup and object are simulated together."""
    n_packings = parameters.pouring.n_packings if parameters.pouring.mode == "replay" else 0
    return [as_planned(packing) for packing in range(n_packings)]


def _task(context: ImaginationContext, one: SetUp) -> Task:
    return packing_task(context.cup(), one.parameters(context.parameters), one.packing)


def _settings_key(parameters: Parameters, one: SetUp) -> str:
    """Everything that a run depends on."""
    part = part_of(parameters, _CUP_READS).model_dump(mode="json")
    return json.dumps([part, one.packing, one.candy_scale], sort_keys=True)
