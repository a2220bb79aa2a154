"""The footprint from above: which candies stayed, and the frame the pours are counted in."""

from __future__ import annotations

from math import pi
from typing import TYPE_CHECKING

import numpy as np

from core.imagination.results import Containability, Footprint
from core.report.drawing import Palette, new_figure, palette, to_png

if TYPE_CHECKING:
    from matplotlib.axes import Axes

MM = 1000.0
_SHORTEST_AXIS_MM = 4.0


def footprint_plot(containability: Containability, *, dark: bool = False) -> bytes:
    """Draw the drop from above as PNG, in millimetres of the reconstruction's frame (Sec. III-A).

    The AABB, all drop positions with the retained ones marked, the footprint's centre p_E and its principal
    axes, two standard deviations each way.
    """
    colors = palette(dark)
    figure = new_figure(5.6, 5.4, colors)
    axes = figure.add_subplot()
    _draw_box(axes, containability, colors)
    _draw_candies(axes, containability, colors)
    if containability.footprint is not None:
        _draw_frame(axes, containability.footprint, colors)
    _dress(axes, colors)
    figure.legend(
        *axes.get_legend_handles_labels(),
        loc="outside lower center",
        ncols=3,
        frameon=False,
        fontsize=10.5,
        labelcolor=colors.text,
        columnspacing=1.4,
        handlelength=1.8,
    )
    return to_png(figure)


def _draw_box(axes: Axes, containability: Containability, colors: Palette) -> None:
    from matplotlib.patches import Rectangle

    low, high = containability.aabb_m[:, :2] * MM
    axes.add_patch(
        Rectangle(low, *(high - low), fill=False, edgecolor=colors.text, linewidth=1.4, label="bounding box")
    )


def _draw_candies(axes: Axes, containability: Containability, colors: Palette) -> None:
    kept = containability.retained.astype(bool)
    x, y = containability.drop_positions_m[:, :2].T * MM
    n_lost = containability.n_drop - containability.n_in
    axes.scatter(
        x[kept], y[kept], s=34, marker="o", color=colors.kept, linewidths=0, label=f"stayed: {kept.sum()}"
    )
    axes.scatter(
        x[~kept], y[~kept], s=26, marker="x", color=colors.lost, linewidths=1.3, label=f"fell: {n_lost}"
    )


def _draw_frame(axes: Axes, footprint: Footprint, colors: Palette) -> None:
    from matplotlib.patheffects import Normal, withStroke

    outline = [withStroke(linewidth=5.5, foreground=colors.background), Normal()]
    center = footprint.center_m[:2] * MM
    for turn, deviation_m, style in zip(
        (0, pi / 2), footprint.deviations_m, ("-", (0, (2.2, 1.4))), strict=True
    ):
        angle = footprint.axis_rad + turn
        reach = np.array([np.cos(angle), np.sin(angle)]) * max(2 * deviation_m * MM, _SHORTEST_AXIS_MM)
        ends = np.array([center - reach, center + reach]).T
        axes.plot(
            *ends,
            color=colors.text,
            linewidth=2.4,
            linestyle=style,
            path_effects=outline,
            label="principal axes, ±2 SD" if turn == 0 else None,
        )
    axes.plot(
        *center,
        marker="P",
        markersize=12,
        linestyle="none",
        color=colors.text,
        markeredgecolor=colors.background,
        markeredgewidth=1.2,
        label="centre $p_E$",
    )


def _dress(axes: Axes, colors: Palette) -> None:
    axes.set_facecolor(colors.background)
    axes.set_aspect("equal", adjustable="datalim")
    axes.margins(0.08)
    axes.set_xlabel("x in mm", fontsize=11, color=colors.text)
    axes.set_ylabel("y in mm", fontsize=11, color=colors.text)
    axes.tick_params(colors=colors.text, labelsize=10.5)
    axes.locator_params(nbins=7)
    for side, spine in axes.spines.items():
        spine.set_visible(side in ("left", "bottom"))
        spine.set_color(colors.faint)
