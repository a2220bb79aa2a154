"""The report's plots: the footprint from above, and the map of the pours."""

from __future__ import annotations

from dataclasses import dataclass
from io import BytesIO
from math import pi
from typing import TYPE_CHECKING, Any

import numpy as np

from core.geometry import FloatArray
from core.imagination.results import Containability, PourChoice, PourGrid
from core.imagination.retention.result import Retention
from core.report.plot_geometry import FootprintPlan, PourMapLayout
from core.report.sentences import MM, direction_text, has_spread

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from matplotlib.projections.polar import PolarAxes

DOTS_PER_INCH = 160


@dataclass(frozen=True)
class Palette:
    """Colours of a page. Kept and lost are blue and orange: distinct with any colour vision."""

    background: str
    text: str
    faint: str
    kept: str
    lost: str


LIGHT = Palette("#ffffff", "#1b1f24", "#b4bac2", "#1f6fb4", "#d9822b")
DARK = Palette("#1d2126", "#e6e9ed", "#59616b", "#62b0f0", "#f0a04b")


def footprint_plot(containability: Containability, *, dark: bool = False) -> bytes:
    """Draw the drop from above as PNG, in millimetres of the reconstruction's frame (Sec. III-A).

    The AABB, all drop positions with the retained ones marked, the footprint's centre p_E and its principal
    axes, two standard deviations each way.
    """
    colors = DARK if dark else LIGHT
    plan = FootprintPlan.of(containability)
    figure = _new_figure(5.6, 5.4, colors)
    axes = figure.add_subplot()
    _draw_drops(axes, plan, colors)
    if plan.center_m is not None and plan.axes_m is not None:
        _draw_frame(axes, plan.center_m, plan.axes_m, colors)
    _dress_plan(axes, colors)
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
    return _to_png(figure)


def pour_map(
    grid: PourGrid, choice: PourChoice | None, containability: Containability, *, dark: bool = False
) -> bytes:
    """Draw the polar map of P as PNG (Sec. III-B): P in per cent in each cell, the chosen one outlined.

    A sector lies where its pivot lies, seen from above with the world's x-axis to the right; the rings are
    not to scale. In the middle, to show the object's orientation, the footprint.
    """
    colors = DARK if dark else LIGHT
    layout = PourMapLayout(tuple(grid.theta_rad), grid.p.shape[1])
    figure = _new_figure(5.6, 6.3, colors)
    axes: PolarAxes = figure.add_subplot(projection="polar")  # type: ignore[assignment]
    shades = _draw_cells(axes, layout, grid, colors)
    if choice is not None:
        for width, color in ((6.5, colors.background), (3.5, colors.text)):
            edge = {"fill": False, "edgecolor": color, "linewidth": width}
            _draw_cell(axes, layout, choice.i, choice.j, **edge, joinstyle="round", zorder=3)
    _draw_footprint(axes, layout, containability, colors)
    _dress_map(axes, layout, grid, colors)
    _draw_scale(figure, axes, shades, colors)
    _describe(figure, grid, choice, colors)
    return _to_png(figure)


def retention_plot(retention: Retention, *, dark: bool = False) -> bytes:
    """Draw as PNG how many of the load are still inside as the object is tilted: mean and worst direction."""
    colors = DARK if dark else LIGHT
    figure = _new_figure(5.6, 3.2, colors)
    axes = figure.add_subplot()
    tilt_deg = np.degrees(retention.tilt_rad)
    curves = (
        ("mean of 8 directions", retention.mean_share_left, colors.kept, "-"),
        ("worst direction", retention.worst_share_left, colors.lost, "--"),
    )
    for label, share, color, style in curves:
        axes.plot(tilt_deg, 100 * share, style, color=color, linewidth=2.2, label=label)
    axes.set_xlim(0, tilt_deg[-1])
    axes.set_ylim(-3, 103)
    axes.set_xticks(np.arange(0, tilt_deg[-1] + 1, 15))
    axes.set_xlabel("Tilt, in degrees", fontsize=11, color=colors.text)
    axes.set_ylabel("Candies still inside, in %", fontsize=11, color=colors.text)
    axes.set_facecolor(colors.background)
    axes.tick_params(colors=colors.text, labelsize=10.5)
    axes.grid(color=colors.faint, linewidth=0.6)
    for side, spine in axes.spines.items():
        spine.set_visible(side in ("left", "bottom"))
        spine.set_color(colors.faint)
    axes.legend(frameon=False, fontsize=10.5, labelcolor=colors.text)
    return _to_png(figure)


def _new_figure(width_in: float, height_in: float, colors: Palette) -> Figure:
    """Make an empty figure that keeps to itself: no window, nothing global."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure((width_in, height_in), DOTS_PER_INCH, facecolor=colors.background, layout="constrained")
    FigureCanvasAgg(figure)
    return figure


def _to_png(figure: Figure) -> bytes:
    buffer = BytesIO()
    # No version or date in the file: the same result gives the same bytes.
    figure.savefig(buffer, format="png", metadata={"Software": None})
    return buffer.getvalue()


def _draw_drops(axes: Axes, plan: FootprintPlan, colors: Palette) -> None:
    from matplotlib.patches import Polygon

    axes.add_patch(
        Polygon(plan.outline_m * MM, fill=False, edgecolor=colors.text, linewidth=1.4, label="bounding box")
    )
    x, y = plan.drops_m.T * MM
    kept, lost = plan.retained, ~plan.retained
    axes.scatter(
        x[kept], y[kept], s=34, marker="o", color=colors.kept, linewidths=0, label=f"stayed: {plan.n_kept}"
    )
    axes.scatter(
        x[lost], y[lost], s=26, marker="x", color=colors.lost, linewidths=1.3, label=f"fell off: {lost.sum()}"
    )


def _draw_frame(axes: Axes, center_m: FloatArray, axes_m: FloatArray, colors: Palette) -> None:
    from matplotlib.patheffects import Normal, withStroke

    outline = [withStroke(linewidth=5.5, foreground=colors.background), Normal()]
    labels = ("principal axes, ±2 SD", None)
    for ends_m, style, label in zip(axes_m, ("-", (0, (2.2, 1.4))), labels, strict=True):
        axes.plot(
            *(ends_m * MM).T,
            color=colors.text,
            linewidth=2.4,
            linestyle=style,
            path_effects=outline,
            label=label,
        )
    axes.plot(
        *(center_m * MM),
        marker="P",
        markersize=12,
        linestyle="none",
        color=colors.text,
        markeredgecolor=colors.background,
        markeredgewidth=1.2,
        label="pour centre",
    )


def _dress_plan(axes: Axes, colors: Palette) -> None:
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


def _draw_cells(axes: PolarAxes, layout: PourMapLayout, grid: PourGrid, colors: Palette) -> Any:
    from matplotlib.cm import ScalarMappable
    from matplotlib.colors import Normalize

    shades: Any = ScalarMappable(Normalize(0, 100), "viridis")  # as Any: its stubs take arrays alone
    for (i, j), ratio in np.ndenumerate(grid.p):
        shade = shades.to_rgba(100 * ratio)
        _draw_cell(axes, layout, i, j, color=shade, edgecolor=colors.background, linewidth=1.6)
        red, green, blue, _ = shade
        ink = "black" if 0.3 * red + 0.59 * green + 0.11 * blue > 0.5 else "white"
        if has_spread(grid):
            _write(axes, layout, i, j, f"{100 * ratio:.0f}", 4, ink, fontsize=13, fontweight="bold")
            _write(axes, layout, i, j, f"±{100 * grid.p_spread[i, j]:.0f}", -8, ink, fontsize=9)
        else:
            _write(axes, layout, i, j, f"{100 * ratio:.0f}", 0, ink, fontsize=13, fontweight="bold")
    return shades


def _draw_cell(axes: PolarAxes, layout: PourMapLayout, i: int, j: int, **style: Any) -> None:
    inner, outer = layout.ring(j)
    axes.bar(layout.directions_rad[i], outer - inner, 2 * layout.half_rad, bottom=inner, **style)


def _write(
    axes: PolarAxes, layout: PourMapLayout, i: int, j: int, text: str, up_points: int, ink: str, **font: Any
) -> None:
    radius, angle_rad = layout.middle(i, j)
    axes.annotate(
        text,
        (angle_rad, radius),
        xytext=(0, up_points),
        textcoords="offset points",
        ha="center",
        va="center",
        color=ink,
        **font,
    )


def _draw_footprint(
    axes: PolarAxes, layout: PourMapLayout, containability: Containability, colors: Palette
) -> None:
    if containability.footprint is None:
        return
    kept = containability.retained.astype(bool)
    offsets = containability.drop_positions_m[kept, :2] - containability.footprint.center_m[:2]
    distances = np.hypot(*offsets.T)
    reach = max(distances.max(), 1e-9)
    axes.scatter(
        np.arctan2(offsets[:, 1], offsets[:, 0]),
        distances / reach * 0.8 * layout.hole,
        s=5,
        color=colors.kept,
        linewidths=0,
        zorder=3,
    )


def _dress_map(axes: PolarAxes, layout: PourMapLayout, grid: PourGrid, colors: Palette) -> None:
    axes.set_facecolor(colors.background)
    axes.set_ylim(0, layout.radius)
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
    lines = [f"Rings, from the inside out: {rings} mm from the pour centre"]
    lines.append("Directions anticlockwise from the x-axis")
    if choice is not None:
        lines[-1] += "; outlined: chosen"
    if len(grid.theta_rad) == 1:
        lines.append("Only one direction was imagined")
    figure.supxlabel("\n".join(lines), fontsize=10.5, color=colors.text, linespacing=1.4)
