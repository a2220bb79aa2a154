"""The command line: everything the program does, without a window (docs/command-line.md is the contract)."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Annotated, Optional

import typer

from app.cli_evaluation import calibrate, cluster, compare, evaluate
from app.cli_options import (
    CellOption,
    PourCellOption,
    PresetOption,
    SeedOption,
    SessionArgument,
    SessionOption,
    SetOption,
    WorkersOption,
)
from core.errors import PoursightError

app = typer.Typer(
    name="poursight",
    help="Can I pour into it? Scan an unknown object, imagine whether it contains, and where to pour.",
    invoke_without_command=True,
    add_completion=False,
    pretty_exceptions_enable=False,
    rich_markup_mode=None,
)


@app.callback()
def desktop(
    context: typer.Context,
    headless_check: Annotated[
        bool,
        typer.Option(
            "--headless-check",
            help="Click through the whole program without a screen, from a new session to poured candies.",
        ),
    ] = False,
) -> None:
    """Can I pour into it? Without a command: the desktop."""
    if headless_check:
        from app.gui.headless_check import check

        raise typer.Exit(check())
    if context.invoked_subcommand is None:
        from app.gui.main import run

        raise typer.Exit(run())


@app.command("import")
def import_scan(
    folder: Annotated[Path, typer.Argument(metavar="FOLDER", help="A scan in the authors' layout.")],
    session: SessionOption,
) -> None:
    """Take a scan into a session: rgbd/frame-*.{color.png,depth.png,pose.txt}, camera-intrinsics.txt."""
    from app import commands

    commands.import_scan(folder, session)


@app.command()
def scan(
    session: SessionOption,
    cell: CellOption = None,
    source: Annotated[
        Optional[str],  # noqa: UP045
        typer.Option(
            "--object", metavar="NAME|MESH", help="In a simulated cell: a built-in object or a mesh file."
        ),
    ] = None,
    adaptive: Annotated[
        bool, typer.Option("--adaptive", help="Take more views where the inside of an opening was not seen.")
    ] = False,
    retake: Annotated[
        Optional[list[str]],  # noqa: UP045
        typer.Option("--retake", metavar="VIEW", help="Take a view of the finished scan again."),
    ] = None,
    restart: Annotated[
        bool, typer.Option("--restart", help="Throw away the views of an interrupted scan.")
    ] = False,
    preset: PresetOption = None,
    settings: SetOption = None,
    workers: WorkersOption = None,
    seed: SeedOption = None,
) -> None:
    """Let the robot look at the object from all sides; by default in the simulated cell."""
    from app import commands
    from app.scanning import ScanWishes

    wishes = ScanWishes(adaptive, tuple(retake or ()), restart)
    commands.scan(session, cell, source, commands.Choices(preset, settings or [], seed), workers, wishes)


@app.command()
def reconstruct(
    session: SessionArgument,
    preset: PresetOption = None,
    settings: SetOption = None,
    workers: WorkersOption = None,
) -> None:
    """Fuse a session's depth images into the object's mesh."""
    from app import commands

    commands.reconstruct(session, commands.Choices(preset, settings or [], None), workers)


@app.command()
def imagine(
    source: Annotated[
        Path, typer.Argument(metavar="SESSION|MESH", help="A session, or a mesh in metres, z up.")
    ],
    preset: PresetOption = None,
    settings: SetOption = None,
    workers: WorkersOption = None,
    seed: SeedOption = None,
    json_file: Annotated[
        Optional[Path],  # noqa: UP045
        typer.Option("--json", metavar="FILE", help="Write the answer there ('-': on stdout)."),
    ] = None,
    session: Annotated[
        Optional[Path],  # noqa: UP045
        typer.Option("--session", metavar="DIR", help="For a mesh: keep everything in this session."),
    ] = None,
) -> None:
    """Imagine whether the object is an open container and how to pour into it."""
    from app import commands

    commands.imagine(source, commands.Choices(preset, settings or [], seed), workers, json_file, session)


@app.command()
def plan(session: SessionArgument, cell: PourCellOption = None, workers: WorkersOption = None) -> None:
    """Say which of the imagined pours the arm can make, and what the chosen one looks like."""
    from app import commands

    commands.plan(session, cell, workers)


@app.command()
def pour(
    session: SessionArgument,
    cell: PourCellOption = None,
    yes: Annotated[bool, typer.Option("--yes", help="Pour without asking.")] = False,
    is_emptied: Annotated[
        bool, typer.Option("--emptied", help="The object was emptied: begin with the first cup.")
    ] = False,
    workers: WorkersOption = None,
) -> None:
    """Show the plan, ask, and let the arm pour; a stopped pour is backed off from and planned anew."""
    from app import commands

    commands.pour(session, cell, yes, is_emptied, workers)


@app.command()
def choose(
    session: SessionArgument,
    i: Annotated[
        Optional[int],  # noqa: UP045
        typer.Argument(metavar="I", min=0, help="Direction, from 0."),
    ] = None,
    j: Annotated[
        Optional[int],  # noqa: UP045
        typer.Argument(metavar="J", min=0, help="Distance, from 0."),
    ] = None,
    reason: Annotated[str, typer.Option("--reason", metavar="TEXT", help="Why this one.")] = "",
    is_withdrawn: Annotated[bool, typer.Option("--withdraw", help="Let the program choose again.")] = False,
) -> None:
    """Choose another pour than the program's, with a reason that is kept."""
    from app import choosing

    if is_withdrawn:
        choosing.withdraw(session)
    elif i is None or j is None:
        raise typer.BadParameter("give I and J, or --withdraw")
    else:
        choosing.choose(session, i, j, reason)


@app.command()
def outcome(
    session: SessionArgument,
    spilled: Annotated[
        Optional[int],  # noqa: UP045
        typer.Option("--spilled", min=0, help="Candies beside the object."),
    ] = None,
    remarks: Annotated[str, typer.Option("--remarks", help="What else was seen.")] = "",
) -> None:
    """Enter what became of the candies of the newest pour."""
    from app import commands

    commands.outcome(session, spilled, remarks)


@app.command()
def report(session: SessionArgument, workers: WorkersOption = None) -> None:
    """Render the evidence of a session and write its report.html."""
    from app import commands

    commands.report(session, workers)


@app.command()
def sessions(
    text: Annotated[
        str, typer.Argument(metavar="TEXT", help="Only sessions that hold each of these words.")
    ] = "",
) -> None:
    """List the sessions in the library, the newest first."""
    from app import library_commands

    library_commands.sessions(text)


@app.command()
def export(
    session: SessionArgument,
    html: Annotated[
        Optional[Path],  # noqa: UP045
        typer.Option("--html", metavar="FILE", help="The report as one file for a browser."),
    ] = None,
    pdf: Annotated[
        Optional[Path],  # noqa: UP045
        typer.Option("--pdf", metavar="FILE", help="The report for paper."),
    ] = None,
    zip_file: Annotated[
        Optional[Path],  # noqa: UP045
        typer.Option("--zip", metavar="FILE", help="The whole session."),
    ] = None,
    overwrite: Annotated[bool, typer.Option("--overwrite", help="Replace files that exist.")] = False,
    workers: WorkersOption = None,
) -> None:
    """Export a session's report as HTML or PDF, or all of the session as ZIP."""
    from app import library_commands

    if html is None and pdf is None and zip_file is None:
        raise typer.BadParameter("give at least one of --html, --pdf and --zip")
    library_commands.export(session, html, pdf, zip_file, overwrite, workers)


@app.command()
def demo(
    name: Annotated[str, typer.Option("--object", metavar="NAME", help="A built-in object.")] = "mug",
    out: Annotated[
        Optional[Path],  # noqa: UP045
        typer.Option("--out", metavar="DIR", help="The session's folder; by default demo/NAME."),
    ] = None,
    preset: PresetOption = None,
    settings: SetOption = None,
    workers: WorkersOption = None,
    seed: SeedOption = None,
) -> None:
    """Do the whole job in the simulated cell: scan, reconstruct, imagine, pour, report."""
    from app import commands

    out = out or Path("demo") / name
    commands.demo(name, out, commands.Choices(preset, settings or [], seed), workers)


for _command in (evaluate, compare, cluster, calibrate):
    app.command()(_command)


@app.command()
def parameters(
    preset: PresetOption = None,
    markdown: Annotated[bool, typer.Option("--markdown", help="As the table in docs/parameters.md.")] = False,
) -> None:
    """List every parameter with its value, unit, range and source."""
    from app import listing

    listing.show_parameters(preset or "default", markdown)


@app.command()
def doctor(cell: CellOption = None) -> None:
    """Check this installation (versions, renderer, known-bad packages, free disk) and a cell's devices."""
    from app.doctor import examine

    raise typer.Exit(examine(cell))


@app.command("ur-controller")
def ur_controller(
    address: Annotated[
        str, typer.Option("--address", metavar="ADDRESS", help="On loopback: 127.x.y.z.")
    ] = "127.0.0.1",
    model: Annotated[str, typer.Option("--model", metavar="MODEL", help="UR5 or UR5e.")] = "UR5",
    version: Annotated[
        str, typer.Option("--version", metavar="V", help="PolyScope: 3.15 (125 Hz) or 5.11 (500 Hz).")
    ] = "3.15",
    speed_up: Annotated[
        float, typer.Option("--speed-up", min=0.1, max=20, help="How much faster than the clock it runs.")
    ] = 1.0,
    fault: Annotated[
        Optional[list[str]],  # noqa: UP045
        typer.Option(
            "--fault", metavar="LINE", help="Such as 'in 5 protective stop', 'when moving link drop'."
        ),
    ] = None,
) -> None:
    """Run a simulated UR controller, which ur_rtde takes for a real one, until Ctrl-C."""
    from app.controller import serve_controller

    serve_controller(address, model, version, speed_up, fault or [])


def main() -> None:
    """Run the command line; what can be explained is one sentence and exit code 1."""
    try:
        app()
    except PoursightError as error:
        print(f"poursight: {error}", file=sys.stderr)
        sys.exit(1)
    except BrokenPipeError:
        sys.stderr.close()  # the reader of our output has gone; nothing is left to say
        sys.exit(1)


if __name__ == "__main__":
    main()
