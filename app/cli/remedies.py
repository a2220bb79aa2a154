"""Remedies as the terminal words them: commands and options."""

from __future__ import annotations

import typer

from core.errors import PoursightError, Remedy

REMEDIES = {
    Remedy.RUN_AGAIN: "Run the same command again.",
    Remedy.CONTINUE: "Run the same command to continue.",
    Remedy.FEWER_WORKERS: "Run the same command with fewer --workers.",
    Remedy.RUN_STAGES: "'poursight report SESSION' makes it anew.",
    Remedy.JUDGE_MOTIONS: "'poursight plan SESSION' makes it anew.",
    Remedy.IMPORT_SCAN: "Import a scan with 'poursight import', or take one with 'poursight scan'.",
    Remedy.NEW_SESSION: "Give another --session.",
    Remedy.CHOOSE_OBJECT: "Name it, such as --object mug; for a real cell give --cell FILE.",
    Remedy.NO_OBJECT: "Put it there and leave out --object.",
    Remedy.OTHER_CELL: "Give another one with --cell FILE.",
    Remedy.EMPTY_HAND: "'poursight pour SESSION' of that pour asks what is in it, and brings a cup home.",
    Remedy.RESTART_SCAN: "Run the same command with --restart to discard them.",
    Remedy.RESTART_CALIBRATION: "Run the same command with --restart to leave them aside.",
    Remedy.START_CLUSTER: "'poursight cluster' starts one and prints its address.",
    Remedy.POUR_ANYWAY: "Add --anyway to pour all the same.",
    Remedy.SCAN_THE_MESH: "'poursight scan --object MESH --session DIR' scans it in the simulated cell.",
}
LONGEST_SENTENCE = 300
_LONGEST_WORD, _LONGEST_START, _LONGEST_END = 80, 20, 57


def worded(error: PoursightError) -> str:
    """Return what went wrong and what to type about it, in one line; of very long paths the ends."""
    said = str(error) if error.remedy is None else f"{error} {REMEDIES[error.remedy]}"
    if len(said) > LONGEST_SENTENCE:
        said = " ".join(_shortened(word) for word in said.split())
    return said if len(said) <= LONGEST_SENTENCE else f"{said[: LONGEST_SENTENCE - 3]}..."


def worded_usage(error: typer.TyperException) -> str:
    """Return which word of a command line cannot be, and who knows better, in one line."""
    context = getattr(error, "ctx", None)
    path = "poursight" if context is None else context.command_path
    text: str = getattr(error, "format_message", error.__str__)()
    said = " ".join(text.split()).rstrip(".")
    end = f". See '{path} --help'."
    if len(said) + len(end) > LONGEST_SENTENCE:
        said = " ".join(_shortened(word) for word in said.split())
    return _both_ends(said, LONGEST_SENTENCE - len(end)) + end


def _both_ends(said: str, most: int) -> str:
    """Return both ends of what is too long: the option is named first, the reason last."""
    if len(said) <= most:
        return said
    half = (most - 3) // 2
    return f"{said[:half]}...{said[-half:]}"


def _shortened(word: str) -> str:
    """The end of a path says more than its middle."""
    return word if len(word) <= _LONGEST_WORD else f"{word[:_LONGEST_START]}...{word[-_LONGEST_END:]}"
