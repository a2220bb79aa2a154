"""The command line: everything the program does, without a window (docs/command-line.md is the contract)."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Annotated, Literal

import typer

from app.cli.cell import cell
from app.cli.evaluation import cluster, compare, evaluate, tune
from app.cli.objects import objects
from app.cli.options import (
    CellOption,
    PourCellOption,
    PresetOption,
    SeedOption,
    SessionArgument,
    SessionOption,
    SetOption,
    WorkersOption,
    given_path,
    given_text,
    given_word,
    written_answer,
    written_file,
)
from app.cli.remedies import worded, worded_usage
from core.errors import PoursightError

app = typer.Typer(
    name="poursight",
    help="Can I pour into it? Scan an unknown object, test whether it holds candies, and find where to pour.",
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
    is_version_asked: Annotated[bool, typer.Option("--version", help="Print the program's version.")] = False,
) -> None:
    """Can I pour into it? Without a command: the desktop."""
    if is_version_asked:
        from importlib.metadata import version

        print(f"Poursight {version('poursight')}")
        raise typer.Exit
    if headless_check:
        from app.gui.headless_check import check

        raise typer.Exit(check())
    if context.invoked_subcommand is None:
        from app.gui.main import run

        raise typer.Exit(run())


@app.command("import")
def import_scan(
    folder: Annotated[
        Path, typer.Argument(metavar="FOLDER", help="A scan in the authors' layout.", parser=given_path)
    ],
    session: SessionOption,
) -> None:
    """Take a scan into a session: rgbd/frame-*.{color.png,depth.png,pose.txt}, camera-intrinsics.txt."""
    from app.cli import session_commands

    session_commands.import_scan(folder, session)


@app.command()
def scan(
    session: SessionOption,
    cell: CellOption = None,
    source: Annotated[
        str | None,
        typer.Option(
            "--object",
            metavar="NAME|MESH",
            help="In a simulated cell: a built-in object or a mesh file.",
            parser=given_word,
        ),
    ] = None,
    adaptive: Annotated[
        bool, typer.Option("--adaptive", help="Take more views where the inside of an opening was not seen.")
    ] = False,
    retake: Annotated[
        list[str] | None,
        typer.Option(
            "--retake", metavar="VIEW", help="Take a view of the finished scan again.", parser=given_word
        ),
    ] = None,
    restart: Annotated[
        bool, typer.Option("--restart", help="Discard the views of an interrupted scan.")
    ] = False,
    yes: Annotated[bool, typer.Option("--yes", help="Let a real arm move without asking.")] = False,
    preset: PresetOption = None,
    settings: SetOption = None,
    workers: WorkersOption = None,
    seed: SeedOption = None,
) -> None:
    """Show the route, ask, and scan an object from all sides; by default in the simulated cell."""
    from app.cli import session_commands
    from app.cli.parameters import Choices
    from app.operations.scan_run import ScanRequest

    request = ScanRequest(adaptive, tuple(retake or ()), restart)
    choices = Choices(preset, settings or [], seed)
    session_commands.scan(session, cell, source, choices, workers, request, yes)


@app.command()
def reconstruct(
    session: SessionArgument,
    preset: PresetOption = None,
    settings: SetOption = None,
    workers: WorkersOption = None,
) -> None:
    """Fuse a session's depth images into the object's mesh."""
    from app.cli import session_commands
    from app.cli.parameters import Choices

    session_commands.reconstruct(session, Choices(preset, settings or [], None), workers)


@app.command()
def imagine(
    source: Annotated[
        Path,
        typer.Argument(
            metavar="SESSION|MESH", help="A session, or a mesh in metres, z up.", parser=given_path
        ),
    ],
    preset: PresetOption = None,
    settings: SetOption = None,
    workers: WorkersOption = None,
    seed: SeedOption = None,
    json_file: Annotated[
        Path | None,
        typer.Option(
            "--json", metavar="FILE", help="Write the answer there ('-': on stdout).", parser=written_answer
        ),
    ] = None,
    session: Annotated[
        Path | None,
        typer.Option(
            "--session",
            metavar="DIR",
            help="For a mesh: store everything in this session.",
            parser=given_path,
        ),
    ] = None,
) -> None:
    """Imagine whether the object is an open container and how to pour into it."""
    from app.cli import session_commands
    from app.cli.parameters import Choices

    session_commands.imagine(source, Choices(preset, settings or [], seed), workers, json_file, session)


@app.command()
def plan(session: SessionArgument, cell: PourCellOption = None, workers: WorkersOption = None) -> None:
    """Say which of the imagined pours the arm can make, and what the chosen one looks like."""
    from app.cli import arm_commands

    arm_commands.plan(session, cell, workers)


@app.command()
def pour(
    session: SessionArgument,
    cell: PourCellOption = None,
    yes: Annotated[bool, typer.Option("--yes", help="Pour without asking.")] = False,
    is_doubt_accepted: Annotated[
        bool, typer.Option("--anyway", help="Pour even if it is not advised, for it is likely to spill.")
    ] = False,
    is_emptied: Annotated[
        bool, typer.Option("--emptied", help="The object was emptied: begin with the first cup.")
    ] = False,
    workers: WorkersOption = None,
) -> None:
    """Show the plan, ask, and let the arm pour; after a stop, back off and plan again."""
    from app.cli import arm_commands

    arm_commands.pour(session, cell, yes, is_doubt_accepted, is_emptied, workers)


@app.command()
def choose(
    session: SessionArgument,
    i: Annotated[int | None, typer.Argument(metavar="I", min=0, help="Direction, from 0.")] = None,
    j: Annotated[int | None, typer.Argument(metavar="J", min=0, help="Distance, from 0.")] = None,
    reason: Annotated[
        str, typer.Option("--reason", metavar="TEXT", help="Why this one.", parser=given_text)
    ] = "",
    is_withdrawn: Annotated[bool, typer.Option("--withdraw", help="Let the program choose again.")] = False,
) -> None:
    """Choose another pour than the program's, and record why."""
    from app.cli import arm_commands

    if is_withdrawn:
        arm_commands.withdraw(session)
    elif i is None or j is None:
        raise typer.BadParameter("give I and J, or --withdraw")
    else:
        arm_commands.choose(session, i, j, reason)


@app.command()
def outcome(
    session: SessionArgument,
    spilled: Annotated[
        int | None, typer.Option("--spilled", min=0, help="Candies that missed the object.")
    ] = None,
    remarks: Annotated[
        str, typer.Option("--remarks", metavar="TEXT", help="What else was seen.", parser=given_text)
    ] = "",
) -> None:
    """Enter the outcome of the newest pour."""
    from app.cli import arm_commands

    arm_commands.outcome(session, spilled, remarks)


@app.command()
def report(session: SessionArgument, workers: WorkersOption = None) -> None:
    """Render the evidence of a session and write its report.html."""
    from app.cli import session_commands

    session_commands.report(session, workers)


@app.command()
def sessions(
    text: Annotated[
        str,
        typer.Argument(
            metavar="TEXT", help="Only sessions that contain each of these words.", parser=given_text
        ),
    ] = "",
) -> None:
    """List the sessions in the library, the newest first."""
    from app.cli import session_commands

    session_commands.sessions(text)


@app.command()
def export(
    session: SessionArgument,
    html: Annotated[
        Path | None,
        typer.Option(
            "--html", metavar="FILE", help="The report as one file for a browser.", parser=written_file
        ),
    ] = None,
    pdf: Annotated[
        Path | None, typer.Option("--pdf", metavar="FILE", help="The report for paper.", parser=written_file)
    ] = None,
    zip_file: Annotated[
        Path | None, typer.Option("--zip", metavar="FILE", help="The whole session.", parser=written_file)
    ] = None,
    overwrite: Annotated[bool, typer.Option("--overwrite", help="Replace files that exist.")] = False,
    workers: WorkersOption = None,
) -> None:
    """Export a session's report as HTML or PDF, or all of the session as ZIP."""
    from app.cli import session_commands

    if html is None and pdf is None and zip_file is None:
        raise typer.BadParameter("give at least one of --html, --pdf and --zip")
    session_commands.export(session, html, pdf, zip_file, overwrite, workers)


@app.command()
def demo(
    name: Annotated[
        str, typer.Option("--object", metavar="NAME", help="A built-in object.", parser=given_word)
    ] = "mug",
    out: Annotated[
        Path | None,
        typer.Option(
            "--out", metavar="DIR", help="The session's folder; by default demo/NAME.", parser=given_path
        ),
    ] = None,
    preset: PresetOption = None,
    settings: SetOption = None,
    workers: WorkersOption = None,
    seed: SeedOption = None,
) -> None:
    """Do the whole job in the simulated cell: scan, reconstruct, imagine, pour, report."""
    from app.cli import session_commands
    from app.cli.parameters import Choices

    out = out or Path("demo") / name
    session_commands.demo(name, out, Choices(preset, settings or [], seed), workers)


for _command in (evaluate, compare, cluster, tune):
    app.command()(_command)
app.command("calibrate", help="The same as 'tune'.")(tune)
app.add_typer(objects, name="objects")
app.add_typer(cell, name="cell")


@app.command()
def parameters(
    preset: PresetOption = None,
    markdown: Annotated[bool, typer.Option("--markdown", help="As the table in docs/parameters.md.")] = False,
) -> None:
    """List every parameter with its value, unit, range and source."""
    from app.cli.parameters import show_parameters

    show_parameters(preset or "default", markdown)


@app.command()
def doctor(
    cell: CellOption = None,
    clear_cache: Annotated[
        bool, typer.Option("--clear-cache", help="First remove the cup runs that sessions share.")
    ] = False,
) -> None:
    """Check this installation (versions, renderer, known-bad packages, free disk) and a cell's devices."""
    from app.cli import arm_commands

    if clear_cache:
        arm_commands.clear_cache()
    raise typer.Exit(0 if arm_commands.doctor(cell) else 1)


@app.command("ur-controller")
def ur_controller(
    address: Annotated[
        str,
        typer.Option("--address", metavar="ADDRESS", help="On loopback: 127.x.y.z.", parser=given_word),
    ] = "127.0.0.1",
    model: Annotated[
        str, typer.Option("--model", metavar="MODEL", help="UR5 or UR5e.", parser=given_word)
    ] = "UR5",
    version: Annotated[
        str,
        typer.Option(
            "--version", metavar="V", help="PolyScope: 3.15 (125 Hz) or 5.11 (500 Hz).", parser=given_word
        ),
    ] = "3.15",
    speed_up: Annotated[
        float, typer.Option("--speed-up", min=0.1, max=20, help="How much faster than the clock it runs.")
    ] = 1.0,
    fault: Annotated[
        list[str] | None,
        typer.Option(
            "--fault",
            metavar="LINE",
            help="Such as 'in 5 protective stop', 'when moving link drop'.",
            parser=given_word,
        ),
    ] = None,
    robotiq: Annotated[
        Literal["2F-85", "2F-140", "Hand-E"] | None,
        typer.Option("--robotiq", help="Serve a Robotiq gripper beside it."),
    ] = None,
) -> None:
    """Run a simulated UR controller, which ur_rtde cannot tell from a real one, until Ctrl-C."""
    from app.cli import arm_commands

    arm_commands.serve_controller(address, model, version, speed_up, fault or [], robotiq)


def main() -> None:
    """Run the command line; what can be explained is one sentence, and exit code 1, or 2 for wrong words."""
    try:
        code = app(prog_name="poursight", standalone_mode=False)
    except PoursightError as error:
        print(f"poursight: {worded(error)}", file=sys.stderr)
        sys.exit(1)
    except typer.TyperException as error:
        print(f"poursight: {worded_usage(error)}", file=sys.stderr)
        sys.exit(2)
    except typer.Abort:
        sys.exit(1)
    except BrokenPipeError:
        sys.stderr.close()  # the reader of our output is gone
        sys.exit(1)
    sys.exit(code or 0)
