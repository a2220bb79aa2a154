"""The verdict's reason in plain words."""

from __future__ import annotations

from PySide6.QtCore import QObject

from core.imagination.results import Containability
from core.report.sentences import paper_verdict_sentence


class Sentences(QObject):
    """Says why an object is, or is not, an open container."""

    def reason(self, found: Containability, n_on_top: int) -> str:
        """What the paper's rule says; if it decides, what had to stay, what did, and where the others are.

        `n_on_top` lie on the object, not in it.
        """
        if found.verdict is not None:
            return paper_verdict_sentence(found)
        needed = self.tr("More than {threshold} of the candies have to stay inside;").format(
            threshold=percent(found.omega_threshold)
        )
        if found.is_open_container:
            return f"{needed} " + self.tr("{omega} did.").format(omega=percent(found.omega))
        if found.n_in == 0:
            did = self.tr("not one of the {n} did.").format(n=found.n_drop)
        else:
            did = self.tr("only {omega} did.").format(omega=percent(found.omega))
        return f"{needed} {did} {self._others(n_on_top)}"

    def _others(self, n_on_top: int) -> str:
        if n_on_top == 0:
            return self.tr("The others fell past it or rolled off.")
        return self.tr(
            "{n} lie on top, with no wall around them; the others fell past it or rolled off."
        ).format(n=n_on_top)


def percent(share: float) -> str:
    """Return a share in per cent, with as many decimals as it needs to differ from nothing."""
    value = 100 * share
    for decimals in (0, 1, 2):
        text = f"{value:.{decimals}f}"
        if float(text) > 0 or value == 0:
            break
    return f"{text}\N{NO-BREAK SPACE}%"
