"""What the cards and the side panel say of a session."""

from __future__ import annotations

from PySide6.QtCore import QCoreApplication

from app.library.summary import SessionSummary
from core.report.sentences import percent, verdict_summary, verdict_words

_CONTEXT = "History"


def verdict_mark(session: SessionSummary) -> tuple[str, str]:
    """Return the sign shown before a verdict, and the name of its colour in the theme."""
    if session.problem:
        return "✕", "failed"
    signs = {True: ("✓", "good"), False: ("⊖", "text"), None: ("○", "muted")}
    if session.is_undecided:
        return "?", "attention"
    return signs[session.is_open_container]


def verdict_title(session: SessionSummary) -> str:
    """Return the verdict in two or three words."""
    if session.problem:
        return QCoreApplication.translate(_CONTEXT, "Cannot be read")
    return verdict_words(session.is_open_container, session.is_undecided)


def verdict_sentence(session: SessionSummary) -> str:
    """Return the verdict with its numbers."""
    if session.problem:
        return verdict_title(session)
    return verdict_summary(
        session.is_open_container,
        session.omega,
        session.omega_threshold,
        session.capacity_share,
        session.capacity_threshold,
        session.is_undecided,
    )


def short_problem(session: SessionSummary) -> str:
    """Return why it cannot be read without the folder, which the card need not repeat."""
    return session.problem.replace(f"{session.path}/", "").replace(str(session.path), session.path.name)


def score_words(session: SessionSummary) -> str:
    """Return the P of the pour to make, for a card; empty without one."""
    translate = QCoreApplication.translate
    if session.chosen is not None:
        return translate(_CONTEXT, "Chosen pour: {p}").format(p=percent(session.chosen.p))
    if session.best is not None:
        return translate(_CONTEXT, "Best pour: {p}").format(p=percent(session.best.p))
    return ""


def best_words(session: SessionSummary) -> str:
    """Return the largest P; empty without pours."""
    return "" if session.best is None else percent(session.best.p)


def chosen_words(session: SessionSummary) -> str:
    """Return the P of the chosen pour, and who chose it; empty without one."""
    if session.chosen is None:
        return ""
    said = QCoreApplication.translate(_CONTEXT, "{p}, chosen by the program")
    if session.operator_reason:
        said = QCoreApplication.translate(_CONTEXT, "{p}, chosen by the operator: {reason}")
    return said.format(p=percent(session.chosen.p), reason=session.operator_reason)


def outcome_words(session: SessionSummary) -> str:
    """Return what became of the candies, short enough for a card."""
    translate = QCoreApplication.translate
    if session.n_runs == 0:
        return translate(_CONTEXT, "Not poured yet") if session.is_open_container else ""
    if session.n_spilled is None:
        return session.outcome
    if session.n_spilled == 0:
        return translate(_CONTEXT, "Poured: none spilled")
    return translate(_CONTEXT, "Poured: {n} spilled").format(n=session.n_spilled)


def date_words(session: SessionSummary) -> str:
    """Return when it was made, by this computer's clock."""
    made = session.created_here
    return session.created if made is None else f"{made:%Y-%m-%d %H:%M}"


def spoken(session: SessionSummary) -> str:
    """Return a card line by line, for a screen reader and as its tooltip."""
    said = (
        session.name,
        verdict_title(session),
        score_words(session),
        session.outcome or outcome_words(session),
        session.problem,
        session.source,
        date_words(session),
    )
    return "\n".join(part for part in said if part)


def results_page(session: SessionSummary) -> str:
    """Return the key of the last page of the workflow that has something to show."""
    if session.n_runs:
        return "robot"
    if session.best is not None:
        return "pours"
    if "containability" in session.stages:
        return "imagination"
    return "reconstruction" if "collision" in session.stages else "scan"
