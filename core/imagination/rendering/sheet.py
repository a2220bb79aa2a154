"""One sheet with the final states of all pours: three distances side by side, opposite directions beside."""

from __future__ import annotations

from math import degrees
from pathlib import Path

import numpy as np
from PIL import Image, ImageDraw

from core.geometry import FloatArray
from core.imagination.rendering.evidence import Evidence
from core.imagination.rendering.labels import BAR_PX, caption_bar, font, rgb, to_png
from core.imagination.rendering.pour_view import open_pours, pour_replay
from core.imagination.rendering.scene import KEPT_COLOR
from core.imagination.rendering.stills import reduced
from core.imagination.results import PourChoice, PourGrid
from core.mesh import TriangleMesh
from core.parameters import Parameters
from core.workers import report_fraction

TILE_PX = (320, 250)
_TITLE = "The end of every pour: three indentations for each direction, opposite directions side by side"
_CAPTION_PX = 26
_GAP_PX = 6
_TEXT_PX = 15
_TEXT_COLOR = (35, 35, 35)
_PAPER_COLOR = (255, 255, 255)


def render_pour_sheet(
    folder: Path,
    surface: TriangleMesh,
    aabb_m: FloatArray,
    cup: TriangleMesh | None,
    grid: PourGrid,
    choice: PourChoice | None,
    parameters: Parameters,
    with_egl: bool,
) -> Evidence:
    """Return the sheet as `pours.png`; the chosen pour is framed.

    Call it in a worker; `folder` takes temporary files, `aabb_m` (2, 3) is what the candies were counted in.
    """
    cells = [(i, j) for i in range(len(grid.recordings)) for j in range(len(grid.recordings[i]))]
    last_poses = [grid.recordings[i][j].T_world_body[-1].astype(float) for i, j in cells]
    shape = len(grid.theta_rad), len(grid.indent_m)
    n_rows, n_columns = np.max([_place(i, j, *shape) for i, j in cells], axis=0) + 1
    sheet = _blank(int(n_rows), int(n_columns))
    width, height = TILE_PX
    with open_pours(folder, surface, cup, last_poses, parameters, width / height, with_egl) as view:
        for index, (i, j) in enumerate(cells):
            report_fraction(index / len(cells))
            replay = pour_replay(grid.recordings[i][j], surface, aabb_m, parameters)
            tile = reduced(view.shoot(replay, -1, 2 * width, 2 * height))
            is_chosen = choice is not None and (i, j) == (choice.i, choice.j)
            _paste(sheet, Image.fromarray(tile), *_place(i, j, *shape), _caption(grid, i, j), is_chosen)
        return Evidence({"pours.png": to_png(np.asarray(sheet))}, view.scene.renderer)


def _place(i: int, j: int, n_directions: int, n_indents: int) -> tuple[int, int]:
    """Row and column of a pour: the second half of the directions stands to the right of the first."""
    half = -(-n_directions // 2)
    return i % half, j + n_indents * (i // half)


def _blank(n_rows: int, n_columns: int) -> Image.Image:
    width, height = TILE_PX
    size = (
        n_columns * (width + _GAP_PX) + _GAP_PX,
        BAR_PX + n_rows * (height + _CAPTION_PX + _GAP_PX) + _GAP_PX,
    )
    sheet = Image.new("RGB", size, _PAPER_COLOR)
    sheet.paste(Image.fromarray(caption_bar(sheet.width, _TITLE)), (0, 0))
    return sheet


def _caption(grid: PourGrid, i: int, j: int) -> str:
    theta = round(degrees(grid.theta_rad[i])) % 360
    return f"theta {theta}°   indent {1000 * grid.indent_m[j]:.0f} mm   P {100 * grid.p[i, j]:.0f} %"


def _paste(
    sheet: Image.Image, tile: Image.Image, row: int, column: int, caption: str, is_chosen: bool
) -> None:
    left = _GAP_PX + column * (tile.width + _GAP_PX)
    top = BAR_PX + _GAP_PX + row * (tile.height + _CAPTION_PX + _GAP_PX)
    sheet.paste(tile, (left, top))
    draw = ImageDraw.Draw(sheet)
    bottom = top + tile.height + _CAPTION_PX
    if is_chosen:
        caption += "   chosen"
        draw.rectangle((left, top + tile.height, left + tile.width - 1, bottom), fill=rgb(KEPT_COLOR))
        outline = (left - 3, top - 3, left + tile.width + 2, bottom + 2)
        draw.rectangle(outline, outline=rgb(KEPT_COLOR), width=4)
    color = _PAPER_COLOR if is_chosen else _TEXT_COLOR
    middle = top + tile.height + _CAPTION_PX // 2
    draw.text((left + 8, middle), caption, fill=color, font=font(_TEXT_PX), anchor="lm")
