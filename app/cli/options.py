"""Arguments and options that several commands share."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

SessionArgument = Annotated[Path, typer.Argument(metavar="SESSION", help="A session's folder.")]
SessionOption = Annotated[Path, typer.Option("--session", metavar="DIR", help="The session's folder.")]
CellOption = Annotated[
    Path | None,
    typer.Option("--cell", metavar="FILE", help="The cell's file; by default the simulated cell."),
]
PourCellOption = Annotated[
    Path | None,
    typer.Option("--cell", metavar="FILE", help="The cell's file; by default the cell of the scan."),
]
PresetOption = Annotated[
    str | None,
    typer.Option("--preset", metavar="P", help="default, paper, authors, or a preset file."),
]
SetOption = Annotated[
    list[str] | None,
    typer.Option("--set", metavar="NAME=VALUE", help="Set a parameter; see 'poursight parameters'."),
]
SeedOption = Annotated[int | None, typer.Option("--seed", help="Seed of all randomness.")]
WorkersOption = Annotated[
    int | None,
    typer.Option("--workers", min=1, max=256, help="Worker processes; by default one a processor."),
]
