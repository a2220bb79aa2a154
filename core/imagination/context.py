"""What every imagination works with: its parameters, where it computes, and what several of them share."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from core.collision import CollisionModel
from core.imagination.body import BodyFile, write_body
from core.imagination.cup import cup_parts
from core.imagination.object_at_rest import ObjectAtRest
from core.mesh import TriangleMesh
from core.parameters import Parameters
from core.parameters.bodies import CupParameters
from core.progress import Reporter
from core.scratch import ScratchFolder
from core.workers import Found, Task, TaskRunner


class BodyFiles:
    """The bodies that the workers read, each written once, in a folder that lives as long as this."""

    def __init__(self) -> None:
        self._folder: ScratchFolder | None = None
        self._objects: dict[int, tuple[tuple[TriangleMesh, ...], BodyFile]] = {}
        self._cups: dict[CupParameters, BodyFile] = {}

    def of_object(self, model: CollisionModel) -> BodyFile:
        """Return the file of an object's body."""
        parts = model.parts
        if id(parts) not in self._objects:
            path = self._new(f"object_{len(self._objects)}")
            # They are kept, so that no others take their identity.
            self._objects[id(parts)] = parts, write_body(path, parts, not model.is_convex)
        return self._objects[id(parts)][1]

    def of_cup(self, cup: CupParameters) -> BodyFile:
        """Return the file of a cup."""
        if cup not in self._cups:
            self._cups[cup] = write_body(self._new(f"cup_{len(self._cups)}"), cup_parts(cup), False)
        return self._cups[cup]

    def _new(self, name: str) -> Path:
        if self._folder is None:
            self._folder = ScratchFolder()
        return self._folder.path / f"{name}.obj"


class Ahead:
    """What idle processors found out about surfaces before anybody asked."""

    def __init__(self) -> None:
        self._made: list[tuple[TriangleMesh, object, Any]] = []

    def keep(self, surface: TriangleMesh, asked: object, result: Any) -> None:
        """Keep a result; `asked` tells what of the surface, and with which settings."""
        self._made.append((surface, asked, result))

    def of(self, surface: TriangleMesh, asked: object) -> Any:
        """Return what was found of that very surface; none if nothing was."""
        made = (result for one, known, result in self._made if one is surface and known == asked)
        return next(made, None)


SpareTask = tuple[Task, Callable[[Any], None]]
"""A task that something later will want, and what takes its result."""


@dataclass(frozen=True)
class ImaginationContext:
    """One imagination's parameters, workers and shared bodies.

    Attributes:
        parameters: those that the imagination reads.
        runner: where to compute.
        reporter: receives the progress.
        bodies: shared by all imaginations of a run.
        spare: fills processors that the next tasks leave idle; emptied by them.
        ahead: what spare tasks found out.
    """

    parameters: Parameters
    runner: TaskRunner
    reporter: Reporter
    bodies: BodyFiles = field(default_factory=BodyFiles)
    spare: list[SpareTask] = field(default_factory=list)
    ahead: Ahead = field(default_factory=Ahead)

    def reading(self, parameters: Parameters) -> ImaginationContext:
        """Return the same with other parameters."""
        return replace(self, parameters=parameters)

    def run(self, tasks: Sequence[Task], stage: str, found: Found | None = None) -> list[Any]:
        """Run tasks in the workers, the spare ones behind them; return the results of `tasks` in order.

        `found` is called with each of these results as soon as it is there.

        Raises:
            Cancelled: somebody asked to stop.
            WorkerError: a worker died.
        """
        spare = list(self.spare)
        self.spare.clear()
        all_tasks = [*tasks, *(task for task, _ in spare)]
        results = self.runner.run(all_tasks, stage, self.reporter, _first(len(tasks), found))
        for (_, take), result in zip(spare, results[len(tasks) :], strict=True):
            take(result)
        return results[: len(tasks)]

    def target(self, model: CollisionModel) -> ObjectAtRest:
        """Return what the physics needs to know of an object that rests where it was scanned."""
        margin_m = self.parameters.collision.aabb_margin_m
        return ObjectAtRest.of(model.surface, self.bodies.of_object(model), margin_m)

    def cup(self) -> BodyFile:
        """Return the body of the cup."""
        return self.bodies.of_cup(self.parameters.pouring.cup)


def _first(n: int, found: Found | None) -> Found | None:
    """Hear of the first n tasks only."""
    if found is None:
        return None

    def hear(index: int, result: Any) -> None:
        if index < n:
            found(index, result)

    return hear
