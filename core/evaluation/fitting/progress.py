"""Progress of a part of a longer work."""

from __future__ import annotations

from core.progress import Reporter


class PartReporter(Reporter):
    """Tells a part's progress as that of the whole."""

    def __init__(self, whole: Reporter, stage: str, begun: float, size: float, total: float) -> None:
        """The part goes from `begun` to `begun + size` of `total`, in the whole's stage."""
        super().__init__()
        self._whole = whole
        self._stage = stage
        self._begun = begun
        self._size = size
        self._total = total

    def progress(self, stage: str, done: float, total: float) -> None:  # noqa: ARG002
        """Tell it as the whole's."""
        share = done / total if total else 1.0
        self._whole.progress(self._stage, self._begun + self._size * share, self._total)

    def warn(self, sentence: str) -> None:
        """Pass it on."""
        self._whole.warn(sentence)

    def raise_if_cancelled(self) -> None:
        """Ask the whole."""
        self._whole.raise_if_cancelled()
