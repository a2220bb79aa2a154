"""How things stand on the Scan page: what may be done now, and what is said of the scan. Knows no widgets."""

from __future__ import annotations

from dataclasses import dataclass, replace
from enum import Enum, auto

from PySide6.QtCore import QCoreApplication

from app.gui.pages.scan.loading import ScanContents
from app.gui.pages.scan.view_table import ViewTable
from app.gui.pages.scan.words import (
    kept_sentence,
    object_title,
    proposal_sentence,
    quality_headline,
    quality_reasons,
    quality_tooltip,
    take_more_text,
)
from app.gui.pages.scan.work import HIDDEN_AREA_M2
from app.gui.views.state_mark import State
from app.jobs.scan_news import Proposal

translate = QCoreApplication.translate


class Deed(Enum):
    """What a button of the page does."""

    NOTHING = auto()
    JUDGE = auto()
    PROPOSE = auto()
    TAKE_MORE = auto()
    TAKE_POOR = auto()


@dataclass(frozen=True, eq=False)
class Situation:
    """Everything that what may be done depends on.

    Attributes:
        contents: of the session; none before they are read.
        views: as they are now.
        source: the object that is chosen for a simulated cell.
        is_ready: whether the user did all that a scan needs.
        is_idle: whether no job is under way.
        is_scanning: whether the arm takes views.
        can_pause: whether it has begun and listens.
        is_paused: whether it was asked to wait.
        is_judging: whether another job of this page is under way.
        is_arm_taken: whether the process that pours holds the real arm.
        is_stale: whether the verdict is from before something was changed.
        is_simulated: whether nothing real moves.
        proposal: of further views, once there is one.
    """

    contents: ScanContents | None
    views: ViewTable
    source: str | None
    is_ready: bool
    is_idle: bool
    is_scanning: bool
    can_pause: bool
    is_paused: bool
    is_judging: bool
    is_arm_taken: bool
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
        return self.is_same and self.contents is not None and self.contents.source == "kept"

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
    """What stands below the view.

    Attributes:
        state: for the mark.
        headline: a sentence.
        details: further ones.
        deed: of the button.
        action: its text.
        tooltip: where the headline's numbers come from.
    """

    state: State
    headline: str
    details: tuple[str, ...] = ()
    deed: Deed = Deed.NOTHING
    action: str = ""
    tooltip: str = ""


def verdict_of(now: Situation) -> Verdict:
    """Say how the scan stands."""
    contents = now.contents
    if now.is_scanning:
        return _scanning(now)
    if contents is None:
        return Verdict("empty", translate("ScanPage", "Reading the session …"))
    if contents.source == "mesh":
        return _mesh(contents)
    if contents.source == "kept":
        return _kept(contents, now)
    if contents.source == "scan" and contents.quality is None:
        return _not_judged(contents, now)
    if contents.source == "scan":
        return replace(_judged(contents, now), tooltip=quality_tooltip())
    return _nothing(contents, now)


def _nothing(contents: ScanContents, now: Situation) -> Verdict:
    if now.is_judging:
        return Verdict("running", translate("ScanPage", "Importing …"))
    n = len(contents.views)
    said = [translate("ScanPage", "Or drop a folder of views or a mesh file anywhere on this page.")]
    if n:
        press = translate("ScanPage", "Press “{button}”: the arm takes {n} views.")
        if not now.is_ready:
            press = translate("ScanPage", "See that the area is clear, then scan: the arm takes {n} views.")
        elif now.is_simulated:
            press = translate("ScanPage", "Press “{button}”: the arm takes {n} views in about 20 s.")
        said.insert(0, press.format(button=now.primary_text, n=n))
    return Verdict("empty", translate("ScanPage", "Nothing is scanned yet."), tuple(said))


def _scanning(now: Situation) -> Verdict:
    done, total = now.views.n_done, len(now.views.views)
    if not now.can_pause:
        return Verdict("running", translate("ScanPage", "Connecting to the cell …"))
    if now.is_paused:
        said = translate("ScanPage", "Paused: {n} of {total} views are taken.").format(n=done, total=total)
        return Verdict("stale", said, (translate("ScanPage", "The arm stands after the view it is at."),))
    if done == total:
        return Verdict("running", translate("ScanPage", "Looking again …"))
    said = translate("ScanPage", "Taking view {n} of {total}.").format(n=done + 1, total=total)
    poor = len(now.views.poor)
    if not poor:
        return Verdict("running", said)
    return Verdict("running", said, (translate("ScanPage", "Poor or left out so far: {n}.").format(n=poor),))


def _mesh(contents: ScanContents) -> Verdict:
    headline = translate("ScanPage", "An imported mesh: it stands in no cell.")
    if contents.extents_m is None:
        return Verdict("fresh", headline)
    x, y, z = (1000 * contents.extents_m).round()
    size = translate("ScanPage", "It is {x:.0f} x {y:.0f} x {z:.0f} mm large.").format(x=x, y=y, z=z)
    return Verdict("fresh", headline, (size,))


def _kept(contents: ScanContents, now: Situation) -> Verdict:
    headline = kept_sentence(contents.n_taken, len(contents.views))
    if now.can_continue and contents.n_taken == len(contents.views):
        said = translate("ScanPage", "Continue takes them over; start anew throws them away.")
    elif now.can_continue:
        said = translate("ScanPage", "Continue takes the others; start anew throws the kept ones away.")
    elif contents.is_of_cell and contents.object_name is not None:
        said = translate("ScanPage", "They show the object “{name}”: choose it to continue.").format(
            name=object_title(contents.object_name)
        )
    else:
        said = translate(
            "ScanPage",
            "They were taken in another cell or with another seed; a scan begins in a new session.",
        )
    return Verdict("stale", headline, (said,))


def _not_judged(contents: ScanContents, now: Situation) -> Verdict:
    if now.is_judging:
        return _being_judged(contents)
    said = translate("ScanPage", "{n} views are taken, but not judged yet.").format(n=contents.n_taken)
    return Verdict("stale", said, (), Deed.JUDGE, translate("ScanPage", "Judge the scan"))


def _being_judged(contents: ScanContents) -> Verdict:
    said = translate("ScanPage", "{n} views are taken and being judged …")
    return Verdict("running", said.format(n=contents.n_taken))


def _judged(contents: ScanContents, now: Situation) -> Verdict:
    quality = contents.quality
    assert quality is not None, "the caller saw it"
    headline = quality_headline(quality, contents.pose_error_m)
    details = quality_reasons(quality, contents.views)
    states: dict[str, State] = {"good": "fresh", "usable": "stale", "scan again": "failed"}
    state = states.get(quality.verdict, "stale")
    if now.is_stale and now.is_judging:
        return _being_judged(contents)
    if now.is_stale:
        said = translate("ScanPage", "Views or parameters were changed since: judge it again.")
        again = translate("ScanPage", "Judge the scan")
        return Verdict("stale", headline, (said, *details), Deed.JUDGE, again)
    if quality.cavity.area_m2 > HIDDEN_AREA_M2 and now.is_same:
        return _hidden(state, headline, details, now)
    poor = len(now.views.poor)
    if poor and now.is_same:
        again = translate("ScanPage", "Take {n} poor again").format(n=poor)
        return Verdict(state, headline, tuple(details), Deed.TAKE_POOR, again)
    return Verdict(state, headline, tuple(details))


def _hidden(state: State, headline: str, details: list[str], now: Situation) -> Verdict:
    """The scan did not see all of the inside: where to look again."""
    if now.proposal is None and now.is_judging:
        return Verdict(
            "running", headline, (translate("ScanPage", "Looking for views that show more …"), *details)
        )
    if now.proposal is None:
        find = translate("ScanPage", "Find views that show it")
        return Verdict(state, headline, tuple(details), Deed.PROPOSE, find)
    details = [proposal_sentence(now.proposal), *details]
    if now.proposal.n_views == 0:
        return Verdict(state, headline, tuple(details))
    return Verdict(state, headline, tuple(details), Deed.TAKE_MORE, take_more_text(now.proposal))


def remarks_of(now: Situation) -> tuple[str, str]:
    """Say what keeps a scan from beginning, and what will happen when it does; both may be empty."""
    if now.is_arm_taken and not now.is_simulated:
        said = translate(
            "ScanPage", "The arm is connected for pouring: disconnect it on the Robot page, then scan."
        )
        return said, ""
    if now.is_scanning or not now.needs_new_session:
        return "", ""
    if now.source is None:
        return "", translate("ScanPage", "A scan begins in a new session; this one stays as it is.")
    said = translate("ScanPage", "A scan of “{name}” begins in a new session; this one stays as it is.")
    return "", said.format(name=object_title(now.source))
