"""The commands that set a cell up; imports nothing heavy."""

from __future__ import annotations

from typing import Annotated, Literal, Optional

import typer

from app.cli.options import given_word

cell = typer.Typer(
    help="A cell from a bare table: devices, board, calibration, places, views, cup, dry run.",
    rich_markup_mode=None,
)

NameArgument = Annotated[
    str, typer.Argument(metavar="NAME|FILE", help="A cell's name, or its file.", parser=given_word)
]
YesOption = Annotated[bool, typer.Option("--yes", help="Let a real arm move without asking.")]
# fmt: off
LengthOption = Annotated[Optional[float], typer.Option("--length-mm", help="From base to mouth, outside.")]  # noqa: UP045
MouthOption = Annotated[Optional[float], typer.Option("--mouth-mm", help="Outer diameter of the mouth.")]  # noqa: UP045
BaseOption = Annotated[Optional[float], typer.Option("--base-mm", help="Outer diameter of the base.")]  # noqa: UP045
WallOption = Annotated[Optional[float], typer.Option("--wall-mm", help="Thickness of wall and base.")]  # noqa: UP045
PayloadOption = Annotated[Optional[float], typer.Option("--payload-kg", help="Gripper, camera, full cup.")]  # noqa: UP045
CupOption = Annotated[Optional[float], typer.Option("--cup-kg", help="Of that the full cup.")]  # noqa: UP045
# fmt: on


@cell.command()
def new(
    name: Annotated[str, typer.Argument(metavar="NAME", help="What people call it.", parser=given_word)],
    simulated: Annotated[
        bool, typer.Option("--simulated", help="A cell without devices, to rehearse in.")
    ] = False,
    seed: Annotated[int, typer.Option("--seed", min=0, help="Of a simulated cell's true set-up.")] = 0,
    address: Annotated[
        Optional[str],  # noqa: UP045
        typer.Option("--address", metavar="A", help="Of a real arm's controller.", parser=given_word),
    ] = None,
) -> None:
    """Write a new cell's file, to be completed step by step."""
    from app.cli import cell_commands

    cell_commands.new(name, simulated, seed, address)


@cell.command()
def board(
    name: NameArgument,
    paper: Annotated[Literal["a4", "letter"], typer.Option("--paper", help="To print on.")] = "a4",
    columns: Annotated[int, typer.Option("--columns", help="Squares in a row.")] = 8,
    rows: Annotated[int, typer.Option("--rows", help="Rows of squares.")] = 5,
    square_mm: Annotated[float, typer.Option("--square-mm", help="Side of a square to print.")] = 30.0,
    dictionary: Annotated[
        str, typer.Option("--dictionary", metavar="NAME", help="Of its markers.", parser=given_word)
    ] = "4X4_50",
    measured_mm: Annotated[
        Optional[float],  # noqa: UP045
        typer.Option("--measured-mm", help="Side of a square as measured on the print."),
    ] = None,
    undo: Annotated[bool, typer.Option("--undo", help="Forget the last entry.")] = False,
) -> None:
    """Print the calibration board to a PDF, and enter what its squares measure."""
    from app.cli import cell_commands

    if undo:
        cell_commands.undo(name, "board")
    else:
        cell_commands.board(name, paper, (columns, rows), square_mm, dictionary, measured_mm)


@cell.command()
def calibrate(
    name: NameArgument,
    views: Annotated[int, typer.Option("--views", min=6, max=60, help="How many views to take.")] = 20,
    restart: Annotated[
        bool, typer.Option("--restart", help="Leave the views of an interrupted run aside.")
    ] = False,
    undo: Annotated[bool, typer.Option("--undo", help="Put back what was there before.")] = False,
    yes: YesOption = False,
) -> None:
    """Find where the camera hangs at the arm, and put it into the cell's file."""
    from app.cli import cell_commands

    if undo:
        cell_commands.undo(name, "hand-eye")
    else:
        cell_commands.calibrate(name, views, restart, yes)


@cell.command()
def check(
    name: NameArgument,
    undo: Annotated[bool, typer.Option("--undo", help="Let the last check count no more.")] = False,
    yes: YesOption = False,
) -> None:
    """Check the calibration with the board in another place."""
    from app.cli import cell_commands

    if undo:
        cell_commands.undo(name, "check")
    else:
        raise typer.Exit(0 if cell_commands.check(name, yes) else 1)


@cell.command()
def touch(
    name: NameArgument,
    tip_mm: Annotated[
        Optional[tuple[float, float, float]],  # noqa: UP045
        typer.Option(
            "--tip-mm", metavar="X Y Z", help="The tip in the flange frame; the middle of the grip at first."
        ),
    ] = None,
) -> None:
    """Compare where the camera has a corner of the checked board with the hand's tip, guided onto it."""
    from app.cli import cell_commands

    raise typer.Exit(0 if cell_commands.touch(name, tip_mm) else 1)


@cell.command()
def devices(name: NameArgument) -> None:
    """Try arm and camera, without moving anything."""
    from app.cli import cell_commands

    raise typer.Exit(0 if cell_commands.devices(name) else 1)


@cell.command()
def table(
    name: NameArgument,
    thickness_mm: Annotated[
        float, typer.Option("--thickness-mm", min=0, max=50, help="Of the board with what it is glued to.")
    ] = 4.0,
    undo: Annotated[bool, typer.Option("--undo", help="Put back what was there before.")] = False,
    yes: YesOption = False,
) -> None:
    """Measure platform and table by the board on the platform's middle; the crop box follows."""
    from app.cli import cell_commands

    if undo:
        cell_commands.undo(name, "table")
    else:
        cell_commands.table(name, thickness_mm, yes)


@cell.command()
def crop(
    name: NameArgument,
    from_mm: Annotated[
        tuple[float, float, float],
        typer.Option("--from-mm", metavar="X Y Z", help="Lower corner, in the arm's base frame."),
    ],
    to_mm: Annotated[
        tuple[float, float, float], typer.Option("--to-mm", metavar="X Y Z", help="Upper corner.")
    ],
) -> None:
    """Enter the box that holds the object: what is outside is no part of it."""
    from app.cli import cell_commands

    cell_commands.crop(name, from_mm, to_mm)


@cell.command()
def views(
    name: NameArgument,
    n: Annotated[int, typer.Option("--n", min=6, max=200, help="How many views at most.")] = 24,
    undo: Annotated[bool, typer.Option("--undo", help="Put back what was there before.")] = False,
) -> None:
    """Choose the views of a scan for this cell and arm, and put them into the cell's file."""
    from app.cli import cell_commands

    if undo:
        cell_commands.undo(name, "views")
    else:
        cell_commands.views(name, n)


@cell.command()
def reference(
    name: NameArgument,
    undo: Annotated[bool, typer.Option("--undo", help="Remove the reference view.")] = False,
    yes: YesOption = False,
) -> None:
    """Store one view of a board that stays; each scan takes it again, to see whether the camera has moved."""
    from app.cli import cell_commands

    if undo:
        cell_commands.undo(name, "reference")
    else:
        cell_commands.reference(name, yes)


@cell.command()
def cup(
    name: NameArgument,
    taught: Annotated[
        bool, typer.Option("--taught", help="The hand holds the standing cup, guided there: read its place.")
    ] = False,
    station_mm: Annotated[
        Optional[tuple[float, float, float]],  # noqa: UP045
        typer.Option(
            "--station-mm", metavar="X Y Z", help="Middle of the cup's foot, in the arm's base frame."
        ),
    ] = None,
    length_mm: LengthOption = None,
    mouth_mm: MouthOption = None,
    base_mm: BaseOption = None,
    wall_mm: WallOption = None,
    payload_kg: PayloadOption = None,
    cup_kg: CupOption = None,
    undo: Annotated[bool, typer.Option("--undo", help="Put back what was there before.")] = False,
) -> None:
    """Enter the cup, where it stands and what it weighs; whether the arm can pour with it is seen at once."""
    from app.cli import cell_commands, cell_cup

    if undo:
        cell_commands.undo(name, "cup")
    else:
        measures = (length_mm, mouth_mm, base_mm, wall_mm)
        cell_cup.cup(name, taught, station_mm, measures, (payload_kg, cup_kg))


@cell.command("dry-run")
def dry_run(
    name: NameArgument,
    undo: Annotated[bool, typer.Option("--undo", help="Let the last dry run count no more.")] = False,
    yes: YesOption = False,
) -> None:
    """Let the arm go through a whole pour with an empty cup, slowly, each move confirmed."""
    from app.cli import cell_commands, cell_cup

    if undo:
        cell_commands.undo(name, "dry-run")
    else:
        cell_cup.dry_run(name, yes)


@cell.command()
def show(name: NameArgument) -> None:
    """List the steps: their state, their figures, and when they were done."""
    from app.cli import cell_commands

    cell_commands.show(name)
