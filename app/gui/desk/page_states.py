"""How each page of the work stands, in a word and a figure: what the tabs show."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

from core.files import read_json
from core.pipeline.needs import Freshness
from core.session import Session
from core.session.pour_runs import pour_runs

if TYPE_CHECKING:
    from app.gui.desk.workspace import Workspace

PageStateWord = Literal["empty", "running", "fresh", "stale", "failed"]
STAGE_OF_PAGE = {
    "reconstruction": "collision",
    "imagination": "containability",
    "pours": "pouring",
}


@dataclass(frozen=True)
class PageState:
    """What a tab says.

    Attributes:
        word: its state.
        figure: the one number or word that matters most, such as "24 views"; may be empty.
    """

    word: PageStateWord
    figure: str = ""


def page_states(
    workspace: Workspace, running_page: str | None, failed_page: str | None
) -> dict[str, PageState]:
    """Return the state of each page of the work.

    Args:
        workspace: the open session.
        running_page: the page of the job that is under way.
        failed_page: the page whose last job failed, until another one ends.
    """
    states = {"scan": _scan(workspace), "robot": _robot(workspace)}
    for page, stage in STAGE_OF_PAGE.items():
        states[page] = PageState(_word(workspace, stage), _figure(workspace, page))
    if failed_page in states:
        states[failed_page] = PageState("failed", states[failed_page].figure)
    if running_page in states:
        states[running_page] = PageState("running", states[running_page].figure)
    return states


def _word(workspace: Workspace, stage: str) -> PageStateWord:
    words: dict[Freshness, PageStateWord] = {
        Freshness.EMPTY: "empty",
        Freshness.STALE: "stale",
        Freshness.FRESH: "fresh",
    }
    return words[workspace.stages.get(stage, Freshness.EMPTY)]


def _scan(workspace: Workspace) -> PageState:
    if workspace.session is None:
        return PageState("empty")
    if workspace.has("mesh"):
        return PageState("fresh", workspace.tr("mesh"))
    if not workspace.has("scan"):
        return PageState("empty")
    n = len(list((workspace.session.path / "scan" / "rgbd").glob("*.color.png")))
    return PageState("fresh", workspace.tr("{n} views").format(n=n))


def _robot(workspace: Workspace) -> PageState:
    """A pour belongs to the imagination it was made for."""
    if workspace.session is None:
        return PageState("empty")
    runs = [run for run in pour_runs(workspace.session.path) if not run.is_back_off]
    if not runs:
        return PageState("empty")
    last = runs[-1]
    if not last.is_done:
        return PageState("failed", workspace.tr("stopped"))
    record = workspace.session.record("pouring")
    is_current = record is not None and record.digest == last.imagination
    spilled = last.outcome.n_spilled if last.outcome is not None else None
    figure = workspace.tr("poured") if spilled is None else workspace.tr("{n} spilled").format(n=spilled)
    return PageState("fresh" if is_current else "stale", figure)


def _figure(workspace: Workspace, page: str) -> str:
    session = workspace.session
    if session is None or not workspace.has(STAGE_OF_PAGE[page]):
        return ""
    if page == "imagination":
        return _verdict(session, workspace)
    return _best(session) if page == "pours" else ""


def _verdict(session: Session, workspace: Workspace) -> str:
    table = read_json(session.folder("containability") / "containability.json")
    return workspace.tr("container") if table["is_open_container"] else workspace.tr("no container")


def _best(session: Session) -> str:
    path = session.folder("pouring") / "pours.json"
    if not path.is_file():
        return "–"
    best = max(max(row) for row in read_json(path)["p"])
    return f"{100 * best:.0f} %"
