"""What may be done on the Scan page now, and what is said of the scan. Knows no widgets."""

from __future__ import annotations

from dataclasses import dataclass, replace
from enum import Enum, auto
from math import floor

from PySide6.QtCore import QCoreApplication

from app.gui.pages.scan.loading import ScanContents, object_title
from app.gui.pages.scan.views import ViewTable
from app.gui.pages.scan.work import HIDDEN_AREA_M2
from app.gui.pages.scan_verdict import verdict_reasons, verdict_title
from app.gui.views.state_mark import State
from app.operations.scanning import Proposal

translate = QCoreApplication.translate
_SIMULATED_S = 20
"""About so long the simulated arm takes for all views."""


class Action(Enum):
    """What the button beside the verdict does."""

    NONE = auto()
    CHECK = auto()
    PROPOSE = auto()
    TAKE_MORE = auto()
    TAKE_POOR = auto()


@dataclass(frozen=True, eq=False)
class Situation:
    """Everything that what may be done depends on.

    Attributes:
        contents: of the session; none before they are read.
        failure: why they cannot be read; empty if they can.
        views: as they are now.
        source: the object that is chosen for a simulated cell.
        is_ready: whether the user did all that a scan needs.
        is_idle: whether no job is running.
        is_scanning: whether the arm takes views.
        can_pause: whether the scan has begun and listens.
        is_paused: whether it was asked to wait.
        question: what it waits for, in a sentence; empty if somebody paused it.
        is_checking: whether another job of this page is running.
        is_arm_taken: whether the process that pours holds the real arm.
        was_stopped: whether STOP was pressed, and no arm has been connected since.
        is_stale: whether the verdict is from before something was changed.
        is_simulated: whether nothing real moves.
        proposal: of further views, once there is one.
    """

    contents: ScanContents | None
    failure: str
    views: ViewTable
    source: str | None
    is_ready: bool
    is_idle: bool
    is_scanning: bool
    can_pause: bool
    is_paused: bool
    question: str
    is_checking: bool
    is_arm_taken: bool
    was_stopped: bool
    is_stale: bool
    is_simulated: bool
    proposal: Proposal | None

    @property
    def is_same(self) -> bool:
        """Whether the session's scan is of the chosen object in the chosen cell."""
        contents = self.contents
        return contents is not None and contents.is_of_cell and contents.object_name == self.source

    @property
    def needs_new_session(self) -> bool:
        """Whether the open session holds something that a scan must not mix with."""
        return self.contents is not None and self.contents.source != "nothing" and not self.is_same

    @property
    def can_scan(self) -> bool:
        """Whether a scan can begin."""
        return self.contents is not None and self.is_idle and self.is_ready and not self.is_arm_taken

    @property
    def can_take_again(self) -> bool:
        """Whether single views can be taken again."""
        return self.can_scan and self.is_same and self.contents is not None and self.contents.source == "scan"

    @property
    def can_continue(self) -> bool:
        """Whether an interrupted scan can be continued."""
        return self.is_same and self.contents is not None and self.contents.source == "interrupted"

    @property
    def primary_text(self) -> str:
        """What the page's button does."""
        if self.is_scanning:
            return translate("ScanPage", "Resume") if self.is_paused else translate("ScanPage", "Pause")
        if self.can_continue:
            return translate("ScanPage", "Continue scan")
        if self.is_same:
            return translate("ScanPage", "Scan again")
        if self.source is None or "." in self.source:
            return translate("ScanPage", "Scan")
        return translate("ScanPage", "Scan the {object}").format(object=self.source)


@dataclass(frozen=True)
class Verdict:
    """What is said below the view.

    Attributes:
        state: for the mark.
        headline: a sentence.
        details: further ones.
        action: of the button.
        button: its text.
        tooltip: where the headline's numbers come from.
    """

    state: State
    headline: str
    details: tuple[str, ...] = ()
    action: Action = Action.NONE
    button: str = ""
    tooltip: str = ""


def verdict_of(now: Situation) -> Verdict:
    """Say how good the scan is, or how far."""
    contents = now.contents
    if now.is_scanning:
        return _scanning(now)
    if contents is None and now.failure:
        return Verdict("failed", translate("ScanPage", "The scan cannot be shown."), (now.failure,))
    if contents is None:
        return Verdict("empty", translate("ScanPage", "Loading the session …"))
    if contents.source == "mesh":
        return _mesh(contents)
    if contents.source == "interrupted":
        return _interrupted(contents, now)
    if contents.source == "scan" and contents.quality is None:
        return _unchecked(contents, now)
    if contents.source == "scan":
        tooltip = translate(
            "ScanPage",
            "Seen: share of the reconstructed surface, undersides excepted, that at least one view saw.\n"
            "Pose error: how far off the surface lies that one view shows, after the views were aligned.",
        )
        return replace(_checked(contents, now), tooltip=tooltip)
    return _nothing(contents, now)


def _nothing(contents: ScanContents, now: Situation) -> Verdict:
    if now.is_checking:
        return Verdict("running", translate("ScanPage", "Importing …"))
    details = [translate("ScanPage", "Or drop a folder of views or a mesh file anywhere on this page.")]
    n = len(contents.views)
    if n:
        if not now.is_ready:
            said = translate("ScanPage", "Make sure the area is clear, then scan: the arm takes {n} views.")
        elif now.is_simulated:
            said = translate("ScanPage", "Press “{button}”: the arm takes {n} views in about {s} s.")
        else:
            said = translate("ScanPage", "Press “{button}”: the arm takes {n} views.")
        details.insert(0, said.format(button=now.primary_text, n=n, s=_SIMULATED_S))
    return Verdict("empty", translate("ScanPage", "Nothing has been scanned yet."), tuple(details))


def _scanning(now: Situation) -> Verdict:
    done, total = now.views.n_done, len(now.views.views)
    if not now.can_pause:
        return Verdict("running", translate("ScanPage", "Connecting to the cell …"))
    if now.is_paused and now.question:
        return Verdict("stale", now.question, (translate("ScanPage", "Resume says yes, Cancel says no."),))
    if now.is_paused:
        said = translate("ScanPage", "Paused: {n} of {total} views taken.").format(n=done, total=total)
        return Verdict("stale", said, (translate("ScanPage", "The arm stops after the current view."),))
    if done == total:
        return Verdict("running", translate("ScanPage", "Looking for further views …"))
    said = translate("ScanPage", "Taking view {n} of {total}.").format(n=done + 1, total=total)
    poor = len(now.views.poor)
    if not poor:
        return Verdict("running", said)
    return Verdict("running", said, (translate("ScanPage", "Poor or left out so far: {n}.").format(n=poor),))


def _mesh(contents: ScanContents) -> Verdict:
    headline = translate("ScanPage", "An imported mesh: its place in the cell is not known.")
    if contents.extents_m is None:
        return Verdict("fresh", headline)
    x, y, z = (1000 * contents.extents_m).round()
    size = translate("ScanPage", "Size: {x:.0f} x {y:.0f} x {z:.0f} mm.").format(x=x, y=y, z=z)
    return Verdict("fresh", headline, (size,))


def _interrupted(contents: ScanContents, now: Situation) -> Verdict:
    n, total = contents.n_taken, len(contents.views)
    headline = translate("ScanPage", "The scan was interrupted: {n} of {total} views are stored.")
    if now.can_continue and n == total:
        said = translate("ScanPage", "Continue uses them; Start over discards them.")
    elif now.can_continue:
        said = translate("ScanPage", "Continue takes the others; Start over discards the {n} views.")
    elif contents.is_of_cell and contents.object_name is not None:
        said = translate("ScanPage", "They show the object “{name}”: choose it to continue.")
    else:
        said = translate(
            "ScanPage",
            "They were taken in another cell or with another seed; a new scan starts in a new session.",
        )
    name = object_title(contents.object_name or "")
    return Verdict("stale", headline.format(n=n, total=total), (said.format(n=n, name=name),))


def _unchecked(contents: ScanContents, now: Situation) -> Verdict:
    if now.is_checking:
        return _being_checked(contents)
    said = translate("ScanPage", "{n} views taken, not checked yet.").format(n=contents.n_taken)
    return Verdict("stale", said, (), Action.CHECK, translate("ScanPage", "Check the scan"))


def _being_checked(contents: ScanContents) -> Verdict:
    return Verdict("running", translate("ScanPage", "Checking {n} views …").format(n=contents.n_taken))


def _checked(contents: ScanContents, now: Situation) -> Verdict:
    quality = contents.quality
    assert quality is not None, "the caller saw it"
    headline = translate("ScanPage", "{verdict}: {share} % of the surface seen").format(
        verdict=verdict_title(quality), share=floor(100 * (1 - quality.unseen_share))
    )
    if contents.pose_error_m is not None:
        error_mm = 1000 * contents.pose_error_m
        headline += translate("ScanPage", ", pose error about {error:.1f} mm").format(error=error_mm)
    details = verdict_reasons(quality)
    states: dict[str, State] = {"good": "fresh", "usable": "stale", "scan again": "failed"}
    state = states.get(quality.verdict, "stale")
    if now.is_stale and now.is_checking:
        return _being_checked(contents)
    if now.is_stale:
        said = translate("ScanPage", "Views or parameters have changed since; check the scan again.")
        button = translate("ScanPage", "Check the scan")
        return Verdict("stale", headline, (said, *details), Action.CHECK, button)
    if quality.cavity.area_m2 > HIDDEN_AREA_M2 and now.is_same:
        return _hidden(state, headline, details, now)
    poor = len(now.views.poor)
    if poor and now.is_same:
        button = translate("ScanPage", "Retake {n} poor views")
        if poor == 1:
            button = translate("ScanPage", "Retake the poor view")
        return Verdict(state, headline, tuple(details), Action.TAKE_POOR, button.format(n=poor))
    return Verdict(state, headline, tuple(details))


def _hidden(state: State, headline: str, details: list[str], now: Situation) -> Verdict:
    """The scan did not see all of the inside: which further views would show it."""
    proposal = now.proposal
    if proposal is None and now.is_checking:
        said = translate("ScanPage", "Looking for views that show more …")
        return Verdict("running", headline, (said, *details))
    if proposal is None:
        button = translate("ScanPage", "Find views that show it")
        return Verdict(state, headline, tuple(details), Action.PROPOSE, button)
    if proposal.n_views == 0:
        said = translate("ScanPage", "No view within the arm's reach would show more of the inside.")
        return Verdict(state, headline, (said, *details))
    said = translate("ScanPage", "{n} more views would show about {share} % of the unseen inside.")
    button = translate("ScanPage", "Take {n} more views")
    if proposal.n_views == 1:
        said = translate("ScanPage", "One more view would show about {share} % of the unseen inside.")
        button = translate("ScanPage", "Take the view")
    n, share = proposal.n_views, max(round(100 * proposal.revealed_share), 1)
    details = [said.format(n=n, share=share), *details]
    return Verdict(state, headline, tuple(details), Action.TAKE_MORE, button.format(n=n))


def remarks_of(now: Situation) -> tuple[str, str]:
    """Say what keeps a scan from beginning, and what will happen when it does; both may be empty."""
    if now.is_arm_taken and not now.is_simulated:
        said = translate(
            "ScanPage", "The arm is connected for pouring: disconnect it on the Robot page first."
        )
        return said, ""
    if now.was_stopped and now.is_idle and not now.is_ready:
        said = translate(
            "ScanPage",
            "STOP was pressed: the arm is drawn see-through where it was last seen. Go there, and see that "
            "nothing is in its way.",
        )
        return said, ""
    if now.is_scanning or not now.needs_new_session:
        return "", ""
    if now.source is None:
        return "", translate("ScanPage", "The scan starts in a new session; this one stays unchanged.")
    said = translate("ScanPage", "The scan of “{name}” starts in a new session; this one stays unchanged.")
    return "", said.format(name=object_title(now.source))
