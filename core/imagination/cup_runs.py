"""Runs of the cup alone, made when first asked for: they know no object, so objects can share them."""

from __future__ import annotations

from collections.abc import Sequence

from core.imagination.body import body_files
from core.imagination.cup import cup_parts
from core.imagination.packing import CupRun, packing_task
from core.imagination.risk.set_up import SetUp
from core.parameters import Parameters
from core.progress import Reporter
from core.workers import TaskRunner

STAGE = "pouring"


class CupRuns:
    """What leaves the cup with each packing and size of candies."""

    def __init__(self, parameters: Parameters) -> None:
        """Begin with none."""
        self._parameters = parameters
        self._known: dict[tuple[int, float], CupRun] = {}

    def add(self, set_up: SetUp, run: CupRun) -> None:
        """Take over a run that was made elsewhere."""
        self._known[_key(set_up)] = run

    def of(self, set_ups: Sequence[SetUp], runner: TaskRunner, reporter: Reporter) -> list[CupRun]:
        """Return the run of each set-up.

        Raises:
            StageError: the cup cannot hold N_pour.
        """
        missing = [set_up for set_up in set_ups if _key(set_up) not in self._known]
        if missing:
            with body_files(cup=(cup_parts(self._parameters.pouring.cup), False)) as files:
                tasks = [
                    packing_task(files["cup"], set_up.parameters(self._parameters), set_up.packing)
                    for set_up in missing
                ]
                for set_up, run in zip(missing, runner.run(tasks, STAGE, reporter), strict=True):
                    self.add(set_up, run)
        return [self._known[_key(set_up)] for set_up in set_ups]


def _key(set_up: SetUp) -> tuple[int, float]:
    return set_up.packing, set_up.candy_scale
