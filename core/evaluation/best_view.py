"""Judging by looks: of all views the best one counts, chosen on the objects themselves (Sec. V-A).

"We evaluate the classification accuracy and AUC [...] for the 24 views, respectively. The highest accuracy
and AUC is selected." That choice knows the labels, so what the other views are worth is said beside it.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace

from core.evaluation.trials import Trial


@dataclass(frozen=True)
class ViewAccuracies:
    """Shares judged right, an object that a view does not show not being right.

    Attributes:
        by_view: of each view, by name.
        best: the view that counts.
        top_down: from each object's most steeply downward view.
    """

    by_view: Mapping[str, float]
    best: str
    top_down: float

    @property
    def mean(self) -> float:
        """Over the views."""
        return sum(self.by_view.values()) / len(self.by_view)


def from_best_views(trials: Iterable[Trial]) -> tuple[Trial, ...]:
    """Return trials such that those of a variant judged by looks are judged from its best view."""
    known = tuple(trials)
    best = {}
    for variant in {one.variant for one in known}:
        found = view_accuracies([one for one in known if one.variant == variant])
        if found is not None:
            best[variant] = found.best
    return tuple(
        one if one.view is None or one.variant not in best else replace(one, view=best[one.variant])
        for one in known
    )


def view_accuracies(trials: Sequence[Trial]) -> ViewAccuracies | None:
    """Find a variant's best view: the most accurate one, of several the one with the largest AUC.

    Args:
        trials: of one variant.

    Returns:
        None where nothing labelled was judged by looks.
    """
    labelled = [one for one in trials if one.label != "ambiguous" and (one.view is not None or one.problem)]
    views = sorted({view for one in labelled for view in one.view_scores})
    if not views:
        return None
    by_view = {view: _accuracy([replace(one, view=view) for one in labelled]) for view in views}
    best = max(views, key=lambda view: (by_view[view], _auc(labelled, view)))
    return ViewAccuracies(by_view, best, _accuracy([replace(one, view=one.top_down) for one in labelled]))


def _accuracy(labelled: Sequence[Trial]) -> float:
    return sum(bool(one.is_right) for one in labelled) / len(labelled)


def _auc(labelled: Sequence[Trial], view: str) -> float:
    """Share of pairs in which the container has the larger score, ties half; 0 without a pair."""
    import numpy as np

    scores = [
        (one.view_scores[view], one.label == "container") for one in labelled if view in one.view_scores
    ]
    containers = np.array([score for score, is_container in scores if is_container])
    others = np.array([score for score, is_container in scores if not is_container])
    if not len(containers) or not len(others):
        return 0.0
    above = containers[:, None] - others
    return float(((above > 0) + 0.5 * (above == 0)).mean())
