"""The same stages without a session: for evaluations, where variants of the parameters share results."""

from __future__ import annotations

import json
from collections.abc import Callable
from time import perf_counter
from typing import Any

from core.collision import CollisionModel
from core.imagination.imagination import Imagination
from core.parameters import Parameters
from core.pipeline.given_mesh import GivenMesh
from core.pipeline.running import Given, Tools, run_stage
from core.pipeline.session_view import IMAGINED
from core.progress import Reporter
from core.reconstruction.result import Reconstruction
from core.stages import GIVEN, MESH, stage
from core.workers import TaskRunner


class StageMemory:
    """Results of stages on one surface, each computed once for all parameters that it does not tell apart.

    Attributes:
        seconds: that each stage took since somebody last emptied it, by name.
    """

    def __init__(self, surface: Reconstruction | GivenMesh, tools: Tools) -> None:
        """Start from a surface; `tools` may be shared by the memories of several objects."""
        self._source = MESH if isinstance(surface, GivenMesh) else "reconstruction"
        self._known: dict[str, Any] = {self._source: surface}
        self._tools = tools
        self.seconds: dict[str, float] = {}

    def result(self, name: str, parameters: Parameters) -> Any:
        """Return a stage's result with these parameters.

        Raises:
            StageError: a stage could not reach a result.
            Cancelled: somebody asked to stop.
        """
        key = self._key(name, parameters)
        if key not in self._known:
            part = stage(name).part(parameters)
            for before in stage(name).inputs_of(self._source):
                self.result(before, parameters)  # so that its seconds are its own
            began_s = perf_counter()
            self._known[key] = run_stage(
                name, self._given(part, lambda other: self.result(other, parameters))
            )
            self.seconds[name] = self.seconds.get(name, 0.0) + perf_counter() - began_s
        return self._known[key]

    def imagination(self, parameters: Parameters) -> Imagination:
        """Return everything that is imagined with these parameters."""
        drop, judgement, planned, grid, tries = (self.result(name, parameters) for name in IMAGINED)
        retention = self.result("retention", parameters)
        return Imagination.of(drop, judgement, planned, grid, tries, retention, cup=parameters.pouring.cup)

    def take_model(self, model: CollisionModel, parameters: Parameters) -> None:
        """Use a body that was built elsewhere, with the collision parameters of `parameters`."""
        self._known[self._key("collision", parameters)] = model

    def _key(self, name: str, parameters: Parameters) -> str:
        """What decides the result: the stages before it, and what each of them reads."""
        if name in (*GIVEN, self._source):
            return name
        one = stage(name)
        before = [self._key(other, parameters) for other in one.inputs_of(self._source)]
        return json.dumps([name, before, one.settings(parameters)], default=str)

    def _given(self, part: Parameters, result: Callable[[str], Any]) -> Given:
        tools = self._tools
        return Given(part, result, self._source, None, {}, tools, tools.context(part))


def imagine(
    model: CollisionModel, parameters: Parameters, runner: TaskRunner, reporter: Reporter
) -> Imagination:
    """Imagine open containability of a body and, if it is an open container, the pours into it.

    Raises:
        StageError: the object is smaller than a candy, or the cup cannot hold N_pour.
    """
    memory = StageMemory(GivenMesh(model.surface, model), Tools(runner, reporter))
    memory.take_model(model, parameters)
    return memory.imagination(parameters)
