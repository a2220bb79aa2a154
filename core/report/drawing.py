"""What the plots have in common: colours for light and dark pages, a figure, its PNG."""

from __future__ import annotations

from dataclasses import dataclass
from io import BytesIO
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from matplotlib.figure import Figure

DOTS_PER_INCH = 160


@dataclass(frozen=True)
class Palette:
    """Colours of a page. Kept and lost are blue and orange: told apart with any colour vision."""

    background: str
    text: str
    faint: str
    kept: str
    lost: str


LIGHT = Palette("#ffffff", "#1b1f24", "#b4bac2", "#1f6fb4", "#d9822b")
DARK = Palette("#1d2126", "#e6e9ed", "#59616b", "#62b0f0", "#f0a04b")


def palette(dark: bool) -> Palette:
    """Return the colours of a light or dark page."""
    return DARK if dark else LIGHT


def new_figure(width_in: float, height_in: float, colors: Palette) -> Figure:
    """Make an empty figure that keeps to itself: no window, nothing global."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure((width_in, height_in), DOTS_PER_INCH, facecolor=colors.background, layout="constrained")
    FigureCanvasAgg(figure)
    return figure


def to_png(figure: Figure) -> bytes:
    """Draw the figure."""
    buffer = BytesIO()
    # No version or date in the file: the same result gives the same bytes.
    figure.savefig(buffer, format="png", metadata={"Software": None})
    return buffer.getvalue()
