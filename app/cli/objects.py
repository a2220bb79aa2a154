"""The commands about objects that are made by code; imports nothing heavy."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Literal, Optional

import typer

from app.cli.options import given_path, given_word

objects = typer.Typer(help="Labelled objects made by code.", rich_markup_mode=None)


@objects.callback()
def _commands() -> None:
    """Labelled objects made by code."""


@objects.command()
def make(
    folder: Annotated[
        Path,
        typer.Argument(metavar="DIR", help="A new folder, for 'poursight evaluate'.", parser=given_path),
    ],
    family: Annotated[
        Optional[list[str]],  # noqa: UP045
        typer.Option(
            "--families", metavar="NAME", help="A family, repeatable; by default all.", parser=given_word
        ),
    ] = None,
    half: Annotated[
        Optional[Literal["development", "judging"]],  # noqa: UP045
        typer.Option("--half", help="Only families to develop with, or only those to judge by."),
    ] = None,
    n: Annotated[
        int, typer.Option("--n", min=1, max=100_000, help="Objects in all, of each family in turn.")
    ] = 100,
    seed: Annotated[int, typer.Option("--seed", min=0, help="Seed of all randomness.")] = 0,
) -> None:
    """Make objects of which it is known by construction what they hold: meshes, labels.csv, members.json."""
    from app.cli.terminal import TerminalReporter
    from app.operations.making_objects import make_objects
    from hardware.simulation.families.catalogue import families_of

    families = families_of(family or [], half)
    with TerminalReporter() as reporter:
        make_objects(folder, families, n, seed, reporter)
    kinds = "family" if len(families) == 1 else "families"
    print(f"{n} objects of {len(families)} {kinds}: {folder}")
