"""The commands that measure how good the judgement is, and tune it; imports nothing heavy."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Literal, Optional

import typer

from app.cli.options import (
    PresetOption,
    SeedOption,
    SetOption,
    WorkersOption,
    given_path,
    given_word,
    written_file,
)

ObjectsArgument = Annotated[
    Path, typer.Argument(metavar="OBJECTS", help="A folder with meshes.", parser=given_path)
]
LabelsOption = Annotated[
    Optional[Path],  # noqa: UP045
    typer.Option(
        "--labels",
        metavar="CSV",
        help="Labels, or raw answers; by default the CSV in OBJECTS.",
        parser=given_path,
    ),
]
InputOption = Annotated[
    Literal["mesh", "scan"],
    typer.Option("--input", help="Scan each object in the simulated cell first, or know its mesh."),
]


def evaluate(
    objects: ObjectsArgument,
    out: Annotated[
        Path,
        typer.Option(
            "--out", metavar="DIR", help="Folder of the results; continued if it exists.", parser=given_path
        ),
    ],
    labels: LabelsOption = None,
    source: InputOption = "scan",
    variant: Annotated[
        Optional[list[str]],  # noqa: UP045
        typer.Option(
            "--variant",
            metavar="NAME",
            help="A row of the tables, repeatable; 'all' for all. By default imagination, paper and authors.",
            parser=given_word,
        ),
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
            help="A setting of the ground-truth simulation, repeatable: object_error_m=0.005.",
            parser=given_word,
        ),
    ] = None,
    world: Annotated[
        Optional[list[str]],  # noqa: UP045
        typer.Option(
            "--world",
            metavar="NAME",
            help="A ground-truth world: bullet, mujoco or peanuts; repeatable. By default all, in turn.",
            parser=given_word,
        ),
    ] = None,
    scheduler: Annotated[
        Optional[str],  # noqa: UP045
        typer.Option("--scheduler", metavar="ADDRESS", help="Compute on a Dask cluster.", parser=given_word),
    ] = None,
    workers: WorkersOption = None,
    preset: PresetOption = None,
    settings: SetOption = None,
    seed: SeedOption = None,
) -> None:
    """Judge labelled objects and pour into them: the paper's Tables I and II, and a report."""
    if scheduler is not None and workers is not None:
        raise typer.BadParameter("--workers is for this machine: the cluster's workers are started with it")
    from app.cli.evaluation_commands import evaluate as evaluate_and_print
    from app.cli.evaluation_commands import ground_truth
    from app.cli.parameters import Choices
    from app.operations.evaluating import EvaluationRequest
    from core.evaluation.variants import DEFAULT, variants_of

    name, parameters = Choices(preset, settings or [], seed).parameters(out)
    request = EvaluationRequest(
        objects,
        labels,
        source,
        tuple(range(parameters.seed, parameters.seed + seeds)),
        variants_of(variant or DEFAULT, has_images=source == "scan"),
        pours,
        name,
        parameters,
        ground_truth(world, truth),
    )
    evaluate_and_print(request, out, workers, scheduler)


def compare(
    before: Annotated[
        Path, typer.Argument(metavar="BEFORE", help="An evaluation's folder.", parser=given_path)
    ],
    after: Annotated[Path, typer.Argument(metavar="AFTER", help="Another one's.", parser=given_path)],
    html: Annotated[
        Optional[Path],  # noqa: UP045
        typer.Option(
            "--html", metavar="FILE", help="By default comparison.html in AFTER.", parser=written_file
        ),
    ] = None,
) -> None:
    """Say what changed from one evaluation to another, and which objects flipped."""
    from app.cli import evaluation_commands

    evaluation_commands.compare(before, after, html)


def cluster(
    workers: WorkersOption = None,
    port: Annotated[
        int, typer.Option("--port", min=0, max=65535, help="Of the scheduler, on loopback; 0: any.")
    ] = 8786,
) -> None:
    """Run a Dask scheduler with workers on this machine until Ctrl-C, to try 'evaluate --scheduler'."""
    from app.cli import evaluation_commands

    evaluation_commands.cluster(workers, port)


def tune(
    objects: ObjectsArgument,
    out: Annotated[
        str,
        typer.Option(
            "--out",
            metavar="PRESET",
            help="A preset's file, or a name: then it is one of yours.",
            parser=given_word,
        ),
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
            parser=given_word,
        ),
    ] = None,
    spills: Annotated[
        Optional[Path],  # noqa: UP045
        typer.Option(
            "--spills",
            metavar="CSV",
            parser=given_path,
            help="Also fit the pours: object, theta (rad), indent (m), spilled.",
        ),
    ] = None,
    truth_spills: Annotated[
        Optional[Path],  # noqa: UP045
        typer.Option(
            "--spills-from-truth",
            metavar="CSV",
            parser=written_file,
            help="Measure them in the ground-truth simulation first, and write them.",
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
    from app.cli.evaluation_commands import preset_path
    from app.cli.evaluation_commands import tune as tune_and_print
    from app.cli.parameters import Choices
    from app.operations.tuning import tuning_request

    path = preset_path(out)  # refused now, not after the fit
    start = Choices(preset or "default", settings or [], seed).parameters(objects)
    request = tuning_request(
        objects,
        labels,
        start,
        source,
        seeds,
        trials,
        parameter or [],
        spills,
        are_spills_to_come=truth_spills is not None,
        all_objects=is_all,
    )
    tune_and_print(request, path, truth_spills, workers)
