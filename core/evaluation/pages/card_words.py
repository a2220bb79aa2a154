"""A card's sentences: what was judged and why, and what became of the pours."""

from __future__ import annotations

from math import degrees

from core.evaluation.trials import Trial

_DECIMALS = (0, 1, 2, 3)
_NBSP = "\N{NO-BREAK SPACE}"


def judged_sentence(trial: Trial) -> str:
    """Say what was judged, and why."""
    if trial.score is None:
        return f"Failed: {trial.problem}"
    if trial.capacity_share is not None:
        return _capacity_sentence(trial, trial.capacity_share)
    verdict = "a container" if trial.is_judged_container else "no container"
    than = "more than" if trial.is_judged_container else "not more than"
    return (
        f"{trial.n_in} of {trial.n_drop} candies stayed: Omega {trial.score:.3f} is {than} the threshold of "
        f"{trial.threshold:.4g}, so it was judged {verdict}."
    )


def poured_sentence(trial: Trial, n_pours: int) -> str:
    """Say what became of the pours; empty if none was to be made."""
    if trial.spilled:
        *most, last = (str(count) for count in trial.spilled)
        counts = f"{', '.join(most)} and {last}" if most else last
        times = "once" if trial.n_pours == 1 else f"{trial.n_pours} times"
        side = "" if trial.theta_rad is None else f" from {degrees(trial.theta_rad) % 360:.0f}\N{DEGREE SIGN}"
        stuck = f" {sum(trial.in_cup)} stayed in the cup." if any(trial.in_cup) else ""
        return f"Poured {times}{side}: {counts} of {trial.n_pour} candies spilled{_promised(trial)}.{stuck}"
    if trial.score is not None and trial.problem:
        return f"Failed: {trial.problem}"
    if trial.label == "container" and n_pours:
        return "Not poured into, which counts as spilled."
    return ""


def _capacity_sentence(trial: Trial, share: float) -> str:
    said, than = _share_texts(share, trial.threshold)
    more = "more than" if trial.is_judged_container else "not more than"
    return (
        f"{_held(trial)}{said}{_NBSP}% of its convex hull, {more} the {than}{_NBSP}% of a "
        f"container{_strength(trial)}."
    )


def _held(trial: Trial) -> str:
    """How a sentence on what it holds begins."""
    if trial.capacity_candies is None or trial.capacity_ml is None:
        return "It holds "
    n = round(trial.capacity_candies)
    if n == 0:
        return "It holds less than one candy, " if trial.capacity_candies else "It holds no candy, "
    candies = f"{n} cand{'y' if n == 1 else 'ies'}"
    return f"It holds {candies} ({trial.capacity_ml:.0f}{_NBSP}ml), "


def _strength(trial: Trial) -> str:
    if trial.holds_rad is None or not trial.capacity_candies:
        return ""
    if trial.holds_rad == 0:
        return "; at the least tilt something leaves"
    return f"; nothing leaves up to {degrees(trial.holds_rad):.0f} degrees"


def _share_texts(share: float, threshold: float) -> tuple[str, str]:
    """Return both in per cent: as few decimals as tell on which side of the threshold the share lies."""
    value, than = 100 * share, f"{100 * threshold:.4g}"
    texts = [f"{value:.{decimals}f}" for decimals in _DECIMALS]
    return next((text for text in texts if _side(float(text), than) == _side(value, than)), texts[-1]), than


def _side(value: float, than: str) -> int:
    return (value > float(than)) - (value < float(than))


def _promised(trial: Trial) -> str:
    """What the imagination expected of the chosen pour, in brackets."""
    said = []
    if trial.p_chosen is not None:
        said.append(f"{100 * trial.p_chosen:.0f}{_NBSP}% land inside")
    if trial.clean_at_least is not None:
        said.append(f"at least {100 * trial.clean_at_least:.0f}{_NBSP}% of such pours spill nothing")
    return f" (imagined: {'; '.join(said)})" if said else ""
