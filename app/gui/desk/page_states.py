"""The state of each page of the work, as a word and a figure: what the tabs show."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from app.gui.views.state_mark import State
from core.errors import SessionError
from core.pipeline.freshness import Freshness
from core.pipeline.session_view import SessionView
from core.quality.verdict_words import AGAIN

if TYPE_CHECKING:
    from app.gui.desk.workspace import Workspace

STAGES_OF_PAGE = {
    "reconstruction": ("collision",),
    "imagination": ("containability", "judgement"),
    "pours": ("pouring", "risk"),
}


@dataclass(frozen=True)
class PageState:
    """What a tab shows.

    Attributes:
        word: its state.
        figure: the one number or word that matters most, such as "24 views"; may be empty.
    """

    word: State
    figure: str = ""


def page_states(workspace: Workspace, running_page: str | None) -> dict[str, PageState]:
    """Return the state of each page of the work.

    Args:
        workspace: the open session.
        running_page: the page of the running job.
    """
    states = {page: _read(workspace, page) for page in ("scan", *STAGES_OF_PAGE, "robot")}
    if running_page in states:
        before = states[running_page]
        # What stages have found is told while those after them run; views and candies are those of before.
        is_found = running_page in STAGES_OF_PAGE and before.word == "fresh"
        states[running_page] = PageState("running", before.figure if is_found else "")
    return states


def _read(workspace: Workspace, page: str) -> PageState:
    """What the session's files say; the page itself tells what is wrong with them."""
    try:
        if page in STAGES_OF_PAGE:
            return PageState(_word(workspace, STAGES_OF_PAGE[page]), _figure(workspace, page))
        return _scan(workspace) if page == "scan" else _robot(workspace)
    except SessionError:
        return PageState("failed", workspace.tr("damaged"))


def with_failure(states: Mapping[str, PageState], page: str | None) -> dict[str, PageState]:
    """Return the states with the page marked whose last job failed, unless another one runs there."""
    if page is None or page not in states or states[page].word == "running":
        return dict(states)
    return dict(states) | {page: PageState("failed")}


def _word(workspace: Workspace, stages: Sequence[str]) -> State:
    """What is finished in part, after an interruption or by an earlier version, is out of date."""
    found = {workspace.stages.get(stage, Freshness.EMPTY) for stage in stages}
    if found == {Freshness.EMPTY}:
        return "empty"
    return "fresh" if found == {Freshness.FRESH} else "stale"


def _scan(workspace: Workspace) -> PageState:
    if workspace.session is None:
        return PageState("empty")
    if workspace.has("mesh"):
        return PageState("fresh", workspace.tr("mesh"))
    if not workspace.has("scan"):
        return PageState("empty")
    if workspace.view is not None and workspace.view.scan_verdict == AGAIN:
        return PageState("failed", workspace.tr("scan again"))
    record = workspace.record("scan")
    n = 0 if record is None else sum(name.endswith(".color.png") for name in record.files)
    return PageState("fresh", workspace.tr("{n} views").format(n=n))


def _robot(workspace: Workspace) -> PageState:
    """The last pour is up to date if it was made for the present imagination."""
    if workspace.session is None:
        return PageState("empty")
    runs = [run for run in workspace.runs if not run.is_back_off]
    if not runs:
        return PageState("empty")
    last = runs[-1]
    if not last.is_done:
        return PageState("failed", workspace.tr("stopped"))
    record = workspace.record("pouring")
    is_current = record is not None and record.digest == last.imagination
    spilled = last.outcome.n_spilled if last.outcome is not None else None
    figure = workspace.tr("poured") if spilled is None else workspace.tr("{n} spilled").format(n=spilled)
    return PageState("fresh" if is_current else "stale", figure)


def _figure(workspace: Workspace, page: str) -> str:
    view = workspace.view
    if view is None:
        return ""
    if page == "imagination" and view.verdict is not None:
        if view.verdict.is_undecided:
            return workspace.tr("cannot tell")
        is_container = view.verdict.is_open_container
        return workspace.tr("container") if is_container else workspace.tr("no container")
    if page == "pours" and "pouring" in view.records:
        return _chosen_p(view)
    return ""


def _chosen_p(view: SessionView) -> str:
    """P of the pour that will be made; a dash if there is none."""
    if view.pours is None or view.place is None:
        return "–"
    i, j = view.place
    return f"{100 * view.pours.p[i][j]:.0f} %"
