"""All evidence of one imagination, its tasks shared among the workers."""

from __future__ import annotations

from pathlib import Path

from core.errors import WorkerError
from core.imagination.rendering.drop_view import render_drop_stills
from core.imagination.rendering.evidence import Evidence
from core.imagination.rendering.films import render_drop_film, render_pour_film
from core.imagination.rendering.pour_view import render_pour_sheet
from core.imagination.results import Containability, PourChoice, PourGrid
from core.mesh import TriangleMesh
from core.parameters import Parameters
from core.progress import Reporter
from core.scratch import ScratchFolder
from core.workers import Task, TaskRunner

STAGE = "evidence"


def render_evidence(
    surface: TriangleMesh,
    cup: TriangleMesh | None,
    parameters: Parameters,
    containability: Containability,
    grid: PourGrid | None,
    choice: PourChoice | None,
    runner: TaskRunner,
    reporter: Reporter,
    early: Path | None = None,
) -> Evidence:
    """Render what `parameters.evidence` asks for, with EGL or, where that fails, with TinyRenderer.

    `surface` is the object at rest in the frame of the recordings, `cup` the cup in its own frame. The folder
    `early` takes each still as soon as it is drawn, for somebody who is watching; the caller clears it.

    Raises:
        Cancelled: the reporter was asked to stop.
        StageError: ffmpeg is missing or made no film.
        WorkerError: the workers die whichever renderer they use.
    """

    def render(folder: Path, with_egl: bool) -> Evidence:
        tasks = _tasks(folder, surface, cup, parameters, containability, grid, choice, with_egl, early)
        parts: list[Evidence] = runner.run(tasks, STAGE, reporter)
        files = {name: content for part in parts for name, content in part.files.items()}
        return Evidence(files, parts[0].renderer if parts else "")

    # The folder is the parent's, so that it goes even when a worker is killed.
    with ScratchFolder() as folder:
        try:
            return render(folder, with_egl=True)
        except WorkerError:
            # Bullet's EGL plugin ends the process when the graphics driver is broken.
            reporter.warn(
                "Drawing with the graphics driver (EGL) failed; drawing continues without it, more slowly."
            )
            return render(folder, with_egl=False)


def _tasks(
    folder: Path,
    surface: TriangleMesh,
    cup: TriangleMesh | None,
    parameters: Parameters,
    containability: Containability,
    grid: PourGrid | None,
    choice: PourChoice | None,
    with_egl: bool,
    early: Path | None,
) -> list[Task]:
    """The longest first, so that two workers end at about the same time; weights are seconds, roughly.

    The stills, which take least, come second: somebody may be waiting for them.
    """
    aabb_m, wanted = containability.aabb_m, parameters.evidence
    drop = (folder, surface, containability, parameters, with_egl)
    tasks = []
    if wanted.films:
        tasks.append(Task(render_drop_film, drop, 8.0))
    if wanted.renders:
        tasks.append(Task(render_drop_stills, (*drop, early), 1.0))
    if wanted.films and grid is not None and choice is not None:
        pour = (folder, surface, aabb_m, cup, grid, choice, parameters, with_egl)
        tasks.append(Task(render_pour_film, pour, 4.0))
    if wanted.renders and grid is not None:
        sheet = (folder, surface, aabb_m, cup, grid, choice, parameters, with_egl)
        tasks.append(Task(render_pour_sheet, sheet, 2.0))
    return tasks
