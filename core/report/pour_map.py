"""The map of the pours: directions around, distances outwards, P in each cell."""

from __future__ import annotations

from math import pi
from typing import TYPE_CHECKING, Any

import numpy as np

from core.imagination.results import Containability, PourChoice, PourGrid
from core.report.drawing import Palette, new_figure, palette, to_png
from core.report.sentences import direction_text, has_spread

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from matplotlib.projections.polar import PolarAxes

MM = 1000.0
_HOLE = 0.95
"""Radius of the middle, where the footprint is shown, in widths of a ring."""
_N_SECTORS = 8


def pour_map(
    grid: PourGrid, choice: PourChoice | None, containability: Containability, *, dark: bool = False
) -> bytes:
    """Draw the polar map of P as PNG (Sec. III-B): P in per cent in each cell, the chosen one outlined.

    A sector lies where its pivot lies, seen from above with the world's x-axis to the right; the rings are
    not to scale. In the middle, to tell the object's orientation, the footprint.
    """
    colors = palette(dark)
    figure = new_figure(5.6, 6.3, colors)
    axes: PolarAxes = figure.add_subplot(projection="polar")  # type: ignore[assignment]
    shades = _draw_cells(axes, grid, colors)
    _draw_numbers(axes, grid, shades)
    if choice is not None:
        _outline(axes, grid, choice, colors)
    _draw_footprint(axes, containability, colors)
    _dress(axes, grid, colors)
    _draw_scale(figure, axes, shades, colors)
    _describe(figure, grid, choice, colors)
    return to_png(figure)


def _width_rad(grid: PourGrid) -> float:
    """Return a sector's width; a single direction gets one of eight."""
    return 2 * pi / max(len(grid.theta_rad), _N_SECTORS)


def _draw_cells(axes: PolarAxes, grid: PourGrid, colors: Palette) -> Any:
    from matplotlib.cm import ScalarMappable
    from matplotlib.colors import Normalize

    shades = ScalarMappable(Normalize(0, 100), "viridis")
    for j in range(grid.p.shape[1]):
        axes.bar(
            grid.theta_rad,
            1,
            _width_rad(grid),
            bottom=_HOLE + j,
            color=shades.to_rgba(100 * grid.p[:, j]),
            edgecolor=colors.background,
            linewidth=1.6,
        )
    return shades


def _draw_numbers(axes: PolarAxes, grid: PourGrid, shades: Any) -> None:
    for (i, j), ratio in np.ndenumerate(grid.p):
        red, green, blue, _ = shades.to_rgba(100 * ratio)
        ink = "black" if 0.3 * red + 0.59 * green + 0.11 * blue > 0.5 else "white"
        at = (grid.theta_rad[i], _HOLE + j + 0.5)
        small = has_spread(grid)
        axes.annotate(
            f"{100 * ratio:.0f}",
            at,
            xytext=(0, 4 if small else 0),
            textcoords="offset points",
            ha="center",
            va="center",
            fontsize=13,
            fontweight="bold",
            color=ink,
        )
        if small:
            axes.annotate(
                f"±{100 * grid.p_spread[i, j]:.0f}",
                at,
                xytext=(0, -8),
                textcoords="offset points",
                ha="center",
                va="center",
                fontsize=9,
                color=ink,
            )


def _outline(axes: PolarAxes, grid: PourGrid, choice: PourChoice, colors: Palette) -> None:
    for width, color in ((6.5, colors.background), (3.5, colors.text)):
        axes.bar(
            grid.theta_rad[choice.i],
            1,
            _width_rad(grid),
            bottom=_HOLE + choice.j,
            fill=False,
            edgecolor=color,
            linewidth=width,
            joinstyle="round",
            zorder=3,
        )


def _draw_footprint(axes: PolarAxes, containability: Containability, colors: Palette) -> None:
    if containability.footprint is None:
        return
    kept = containability.retained.astype(bool)
    offsets = containability.drop_positions_m[kept, :2] - containability.footprint.center_m[:2]
    distances = np.hypot(*offsets.T)
    reach = max(distances.max(), 1e-9)
    axes.scatter(
        np.arctan2(offsets[:, 1], offsets[:, 0]),
        distances / reach * 0.8 * _HOLE,
        s=5,
        color=colors.kept,
        linewidths=0,
        zorder=3,
    )


def _dress(axes: PolarAxes, grid: PourGrid, colors: Palette) -> None:
    axes.set_facecolor(colors.background)
    axes.set_ylim(0, _HOLE + grid.p.shape[1])
    axes.set_yticks([])
    axes.set_xticks(grid.theta_rad % (2 * pi), [direction_text(angle) for angle in grid.theta_rad])
    axes.tick_params(axis="x", colors=colors.text, labelsize=11, pad=7)
    axes.grid(visible=False)
    axes.spines["polar"].set_color(colors.faint)


def _draw_scale(figure: Figure, axes: PolarAxes, shades: Any, colors: Palette) -> None:
    bar = figure.colorbar(shades, ax=axes, orientation="horizontal", shrink=0.72, aspect=28, pad=0.02)
    bar.set_label("P: candies that land inside, in %", fontsize=11, color=colors.text)
    bar.ax.tick_params(colors=colors.text, labelsize=10.5)
    bar.outline.set_visible(False)


def _describe(figure: Figure, grid: PourGrid, choice: PourChoice | None, colors: Palette) -> None:
    rings = ", ".join(f"{indent_m * MM:.0f}" for indent_m in grid.indent_m)
    lines = [f"Rings, from inside: {rings} mm out from the centre $p_E$"]
    lines.append("Directions anticlockwise from the x-axis")
    if choice is not None:
        lines[-1] += "; outlined: chosen"
    if len(grid.theta_rad) == 1:
        lines.append("Only one direction was imagined")
    figure.supxlabel("\n".join(lines), fontsize=10.5, color=colors.text, linespacing=1.4)
