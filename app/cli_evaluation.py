"""The commands that ask how good the judgement is, and make it better."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Literal, Optional

import typer

from app.cli_options import PresetOption, SeedOption, SetOption, WorkersOption

ObjectsArgument = Annotated[Path, typer.Argument(metavar="OBJECTS", help="A folder with meshes.")]
LabelsOption = Annotated[
    Optional[Path],  # noqa: UP045
    typer.Option("--labels", metavar="CSV", help="Labels, or raw answers; by default the CSV in OBJECTS."),
]
InputOption = Annotated[
    Literal["mesh", "scan"],
    typer.Option("--input", help="Scan each object in the simulated cell first, or know its mesh."),
]


def evaluate(
    objects: ObjectsArgument,
    out: Annotated[
        Path, typer.Option("--out", metavar="DIR", help="Folder of the results; continued if it exists.")
    ],
    labels: LabelsOption = None,
    source: InputOption = "scan",
    variant: Annotated[
        Optional[list[str]],  # noqa: UP045
        typer.Option("--variant", metavar="NAME", help="A row of the tables, repeatable; 'all' for all."),
    ] = None,
    seeds: Annotated[
        int, typer.Option("--seeds", min=1, help="Try each object with so many seeds, from --seed on.")
    ] = 1,
    pours: Annotated[
        int,
        typer.Option(
            "--pours", min=0, max=1000, help="Pours into each object judged a container; 0: judge only."
        ),
    ] = 3,
    truth: Annotated[
        Optional[list[str]],  # noqa: UP045
        typer.Option(
            "--truth",
            metavar="NAME=VALUE",
            help="A setting of the truth world, repeatable: object_error_m=0.005.",
        ),
    ] = None,
    scheduler: Annotated[
        Optional[str],  # noqa: UP045
        typer.Option("--scheduler", metavar="ADDRESS", help="Compute on a Dask cluster."),
    ] = None,
    workers: WorkersOption = None,
    preset: PresetOption = None,
    settings: SetOption = None,
    seed: SeedOption = None,
) -> None:
    """Judge labelled objects and pour into them: the paper's Tables I and II, and a report."""
    if scheduler is not None and workers is not None:
        raise typer.BadParameter("--workers is for this machine: the cluster's workers are started with it")
    from app import commands, evaluation_commands

    wishes = evaluation_commands.EvaluationWishes(
        objects, labels, source, tuple(variant or ()), seeds, pours, tuple(truth or ())
    )
    choices = commands.Choices(preset, settings or [], seed)
    evaluation_commands.evaluate(wishes, out, choices, workers, scheduler)


def compare(
    before: Annotated[Path, typer.Argument(metavar="BEFORE", help="An evaluation's folder.")],
    after: Annotated[Path, typer.Argument(metavar="AFTER", help="Another one's.")],
    html: Annotated[
        Optional[Path],  # noqa: UP045
        typer.Option("--html", metavar="FILE", help="By default comparison.html in AFTER."),
    ] = None,
) -> None:
    """Say what changed from one evaluation to another, and which objects flipped."""
    from app import evaluation_commands

    evaluation_commands.compare(before, after, html)


def cluster(
    workers: WorkersOption = None,
    port: Annotated[
        int, typer.Option("--port", min=0, max=65535, help="Of the scheduler, on loopback; 0: any.")
    ] = 8786,
) -> None:
    """Run a Dask scheduler with workers on this machine until Ctrl-C, to try 'evaluate --scheduler'."""
    from app.evaluation.engines.own_cluster import serve_cluster

    serve_cluster(workers, port)


def calibrate(
    objects: ObjectsArgument,
    out: Annotated[
        str,
        typer.Option("--out", metavar="PRESET", help="A preset's file, or a name: then it is one of yours."),
    ],
    labels: LabelsOption = None,
    source: InputOption = "scan",
    seeds: Annotated[
        int, typer.Option("--seeds", min=1, help="Judge each object with so many seeds, from --seed on.")
    ] = 3,
    trials: Annotated[
        int, typer.Option("--trials", min=1, help="Sets of values to try; the first is where it starts.")
    ] = 40,
    parameter: Annotated[
        Optional[list[str]],  # noqa: UP045
        typer.Option(
            "--parameter",
            metavar="NAME[=LOW:HIGH]",
            help="Fit this one, repeatable, in this range (SI units).",
        ),
    ] = None,
    spills: Annotated[
        Optional[Path],  # noqa: UP045
        typer.Option(
            "--spills", metavar="CSV", help="Also fit the pours: object, theta (rad), indent (m), spilled."
        ),
    ] = None,
    truth_spills: Annotated[
        Optional[Path],  # noqa: UP045
        typer.Option(
            "--spills-from-truth",
            metavar="CSV",
            help="Measure them in the truth world first, and write them.",
        ),
    ] = None,
    is_all: Annotated[
        bool, typer.Option("--all", help="All labelled objects, not only those marked for calibration.")
    ] = False,
    workers: WorkersOption = None,
    preset: PresetOption = None,
    settings: SetOption = None,
    seed: SeedOption = None,
) -> None:
    """Fit parameters and the threshold to labelled objects, and keep them as a preset."""
    if spills is not None and truth_spills is not None:
        raise typer.BadParameter("give either --spills or --spills-from-truth")
    from app import calibrate_command, commands

    wishes = calibrate_command.FitChoices(
        source, seeds, trials, parameter or [], spills, truth_spills, is_all
    )
    choices = commands.Choices(preset or "default", settings or [], seed)
    calibrate_command.run(objects, labels, out, choices, wishes, workers)
