"""What the cards and the side panel say of a session."""

from __future__ import annotations

from typing import Literal

from PySide6.QtCore import QCoreApplication

from app.library.summary import SessionSummary

Verdict = Literal["container", "other", "unknown", "damaged"]
_CONTEXT = "History"


def verdict_of(session: SessionSummary) -> Verdict:
    """Return which mark stands before a session's verdict."""
    if session.problem:
        return "damaged"
    if session.is_open_container is None:
        return "unknown"
    return "container" if session.is_open_container else "other"


def verdict_words(session: SessionSummary) -> str:
    """Return the verdict in two or three words."""
    translate = QCoreApplication.translate
    words: dict[Verdict, str] = {
        "damaged": translate(_CONTEXT, "Cannot be read"),
        "unknown": translate(_CONTEXT, "No verdict yet"),
        "container": translate(_CONTEXT, "Open container"),
        "other": translate(_CONTEXT, "Not a container"),
    }
    return words[verdict_of(session)]


def verdict_sentence(session: SessionSummary) -> str:
    """Return the verdict with its numbers."""
    if session.problem:
        return verdict_words(session)
    if session.omega is None or session.omega_threshold is None:
        return QCoreApplication.translate(
            _CONTEXT, "Whether it is an open container has not been imagined yet."
        )
    if session.capacity_share is not None and session.capacity_threshold is not None:
        return QCoreApplication.translate(
            _CONTEXT, "{verdict}: it holds {share} of its convex hull; it takes more than {threshold}."
        ).format(
            verdict=verdict_words(session),
            share=_percent(session.capacity_share),
            threshold=_percent(session.capacity_threshold),
        )
    return QCoreApplication.translate(
        _CONTEXT, "{verdict}: {omega} of the candies stayed; it takes more than {threshold}."
    ).format(
        verdict=verdict_words(session),
        omega=_percent(session.omega),
        threshold=_percent(session.omega_threshold),
    )


def short_problem(session: SessionSummary) -> str:
    """Return why it cannot be read without the folder, which the card need not repeat."""
    return session.problem.replace(f"{session.path}/", "").replace(str(session.path), session.path.name)


def score_words(session: SessionSummary) -> str:
    """Return the P of the pour to make, for a card; empty without one."""
    translate = QCoreApplication.translate
    if session.chosen is not None:
        return translate(_CONTEXT, "Chosen pour: {p}").format(p=_percent(session.chosen.p))
    if session.best is not None:
        return translate(_CONTEXT, "Best pour: {p}").format(p=_percent(session.best.p))
    return ""


def outcome_words(session: SessionSummary) -> str:
    """Return what became of the candies, short enough for a card."""
    translate = QCoreApplication.translate
    if session.n_runs == 0:
        return translate(_CONTEXT, "Not poured") if session.is_open_container else ""
    if session.n_spilled is None:
        return session.outcome
    if session.n_spilled == 0:
        return translate(_CONTEXT, "Poured: none spilled")
    return translate(_CONTEXT, "Poured: {n} spilled").format(n=session.n_spilled)


def date_words(session: SessionSummary) -> str:
    """Return when it was made, by this computer's clock."""
    made = session.created_here
    return session.created if made is None else f"{made:%Y-%m-%d %H:%M}"


def origin_words(session: SessionSummary) -> str:
    """Return date and source in one line."""
    return "  ·  ".join(said for said in (date_words(session), session.source) if said)


def best_words(session: SessionSummary) -> str:
    """Return the largest P; a dash without pours."""
    return _percent(session.best.p) if session.best is not None else "–"


def chosen_words(session: SessionSummary) -> str:
    """Return the P of the chosen pour, and who chose it."""
    if session.chosen is None:
        return "–"
    p = _percent(session.chosen.p)
    if not session.operator_reason:
        return QCoreApplication.translate(_CONTEXT, "{p}, chosen by the program").format(p=p)
    return QCoreApplication.translate(_CONTEXT, "{p}, chosen by the operator: {reason}").format(
        p=p, reason=session.operator_reason
    )


def size_words(session: SessionSummary) -> str:
    """Return what it takes on the disk."""
    return f"{session.size_bytes / 1e6:.1f} MB"


def spoken(session: SessionSummary) -> str:
    """Return a card in one sentence, for a screen reader and as its tooltip."""
    said = (
        session.name,
        verdict_words(session),
        score_words(session),
        session.outcome or outcome_words(session),
        session.problem,
        origin_words(session),
    )
    return "\n".join(part for part in said if part)


def results_page(session: SessionSummary) -> str:
    """Return the key of the last page of the work that has something to show."""
    if session.n_runs:
        return "robot"
    if session.best is not None:
        return "pours"
    if "containability" in session.stages:
        return "imagination"
    return "reconstruction" if "collision" in session.stages else "scan"


def _percent(share: float) -> str:
    """Per cent, with a decimal where a whole number would hide a small one."""
    return f"{100 * share:.2g} %" if 0 < share < 0.095 else f"{100 * share:.0f} %"
