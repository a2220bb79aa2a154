"""The Scan page's sentences."""

from __future__ import annotations

from math import floor
from pathlib import Path
from typing import TYPE_CHECKING

from PySide6.QtCore import QCoreApplication

from app.jobs.scan_news import Proposal, State, ViewNews

if TYPE_CHECKING:
    from collections.abc import Sequence

    from core.quality.measures import ScanQuality

translate = QCoreApplication.translate


def view_title(index: int) -> str:
    """Return what people call a view; they count from one."""
    return translate("ScanPage", "View {number}").format(number=index + 1)


def state_word(state: State) -> str:
    """Return what became of a view."""
    words: dict[State, str] = {
        "pending": translate("ScanPage", "not taken yet"),
        "taken": translate("ScanPage", "taken"),
        "poor": translate("ScanPage", "taken, but poor"),
        "failed": translate("ScanPage", "left out"),
    }
    return words[state]


def view_headline(index: int, view: ViewNews) -> str:
    """Say what became of a view."""
    return f"{view_title(index)}: {state_word(view.state)}"


def view_problems(view: ViewNews) -> str:
    """Say what is wrong with a view; its frame's name means nothing to people."""
    return " ".join(problem.replace(view.name, translate("ScanPage", "It")) for problem in view.problems)


def quality_headline(quality: ScanQuality, pose_error_m: float | None) -> str:
    """Say in one line how good a scan is."""
    verdicts = {
        "good": translate("ScanPage", "Good scan"),
        "usable": translate("ScanPage", "Usable scan"),
        "scan again": translate("ScanPage", "Scan again"),
    }
    seen = translate("ScanPage", "{share} % of the surface seen").format(
        share=floor(100 * (1 - quality.unseen_share))
    )
    facts = [seen]
    if pose_error_m is not None:
        facts.append(
            translate("ScanPage", "pose error about {error:.1f} mm").format(error=1000 * pose_error_m)
        )
    return f"{verdicts.get(quality.verdict, quality.verdict)}: {', '.join(facts)}"


def quality_tooltip() -> str:
    """Say where the headline's numbers come from."""
    return translate(
        "ScanPage",
        "Seen: share of the reconstructed surface, without what looks down, that at least one view saw.\n"
        "Pose error: how far the surface that one view shows lies off, after the views were made to agree.",
    )


def quality_reasons(quality: ScanQuality, views: Sequence[ViewNews]) -> list[str]:
    """Return why a scan is no better, a sentence each; none for a good one."""
    if quality.verdict == "good":
        return []
    numbers = {view.name: view_title(k) for k, view in enumerate(views)}
    return [_for_people(reason, numbers) for reason in quality.reasons]


def _for_people(reason: str, titles: dict[str, str]) -> str:
    """A reason without the verdict it begins with and without the command line's words."""
    _, _, said = reason.partition(": ")
    said = said.replace("look again with --adaptive", translate("ScanPage", "look again from further views"))
    said = said.replace("are in quality.json", translate("ScanPage", "are told at the views"))
    for name, title in titles.items():
        said = said.replace(name, title)
    return said[:1].upper() + said[1:]


def proposal_sentence(proposal: Proposal) -> str:
    """Say what looking again would bring."""
    if proposal.n_views == 0:
        return translate("ScanPage", "No view that the arm can take would show more of the inside.")
    share = max(round(100 * proposal.revealed_share), 1)
    if proposal.n_views == 1:
        return translate(
            "ScanPage", "One more view would show about {share} % of the inside that was not seen."
        ).format(share=share)
    return translate(
        "ScanPage", "{n} more views would show about {share} % of the inside that was not seen."
    ).format(n=proposal.n_views, share=share)


def take_more_text(proposal: Proposal) -> str:
    """Return the text of the button that takes them."""
    if proposal.n_views == 1:
        return translate("ScanPage", "Take the view")
    return translate("ScanPage", "Take {n} more views").format(n=proposal.n_views)


def kept_sentence(n_taken: int, n_planned: int) -> str:
    """Say what an interrupted scan left."""
    if n_taken == n_planned:
        return translate("ScanPage", "A scan was interrupted: all {n} views are kept.").format(n=n_planned)
    return translate("ScanPage", "A scan was interrupted: {n} of {total} views are kept.").format(
        n=n_taken, total=n_planned
    )


def object_title(source: str) -> str:
    """Return what people call an object: a built-in one by its name, a mesh by its file's name."""
    path = Path(source)
    return path.name if path.suffix else source.capitalize()
