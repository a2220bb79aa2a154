"""What the pours into any object will ask for, so that it can be computed before the object is known."""

from __future__ import annotations

import numpy as np

from core.imagination.amount.reasoning import is_one_cup_asked_for
from core.imagination.context import ImaginationContext
from core.imagination.cup_runs import CupRuns, planned_set_ups
from core.imagination.risk.drawing import draw_cups
from core.imagination.risk.result import lower_bound
from core.imagination.set_up import SetUp
from core.parameters import Parameters


def set_ups_ahead(parameters: Parameters) -> list[SetUp]:
    """Return the set-ups whose runs of the cup will be asked for: of the pours, and of the first one's tries.

    None if the amount depends on the object.

    Raises:
        StageError: the cup cannot hold N_pour.
    """
    if not is_one_cup_asked_for(parameters):
        return []
    tries = range(_tries_without_a_spill(parameters))
    anywhere_m = np.zeros(3)  # where the object stands makes no difference to the cup
    return [*planned_set_ups(parameters), *(draw_cups(parameters, k, 1, anywhere_m)[0] for k in tries)]


class CupRunsAhead:
    """Makes those runs a few at a time, so that whoever has something better to do need not wait."""

    def __init__(self, context: ImaginationContext, runs: CupRuns) -> None:
        """Begin; raises as `set_ups_ahead` does."""
        self._context = context
        self._runs = runs
        self._left = set_ups_ahead(context.parameters)

    def make_some(self) -> bool:
        """Make one run for each worker; return whether there are more to make.

        Raises:
            Cancelled: the context's reporter was asked to stop.
            WorkerError: a worker died.
        """
        n_workers = self._context.runner.workers
        some, self._left = self._left[:n_workers], self._left[n_workers:]
        self._runs.of(self._context, some)
        return bool(self._left)


def _tries_without_a_spill(parameters: Parameters) -> int:
    """After so many clean tries of a pour, besides the planned one, there are no more."""
    settings = parameters.risk
    n_tries = np.arange(settings.n_tries + 1)
    is_sure = lower_bound(n_tries + 1, n_tries + 1) >= settings.sure_enough
    return int(is_sure.argmax()) if is_sure.any() else settings.n_tries
