"""Pours made visible: the object, the transparent cup, the candies by their fate; and one sheet of them all.

The sheet shows the final states: three distances side by side, opposite directions beside each other.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from math import degrees
from pathlib import Path

import numpy as np
from PIL import Image, ImageDraw

from core.geometry import FloatArray, transform_points
from core.imagination.particle_shape import particle_extents_m
from core.imagination.recording import Recording
from core.imagination.rendering.camera import Camera, aabb_corners, frame
from core.imagination.rendering.evidence import Evidence
from core.imagination.rendering.pictures import BAR_PX, SUPERSAMPLING, caption_bar, font, reduced, rgb, to_png
from core.imagination.rendering.replay import Replay, make_replay, poured_in
from core.imagination.rendering.scene import KEPT_COLOR, OBJECT_COLOR, Picture, Scene
from core.imagination.results import PourChoice, PourGrid
from core.mesh import TriangleMesh
from core.parameters import Parameters
from core.workers import report_fraction

_GROUND_GAP_M = 0.0005
TILE_PX = (320, 250)
_TITLE = "The end of every pour: three indents for each direction, opposite directions side by side"
_CAPTION_PX = 26
_GAP_PX = 6
_TEXT_PX = 15
_TEXT_COLOR = (35, 35, 35)
_PAPER_COLOR = (255, 255, 255)


@dataclass(frozen=True)
class PourView:
    """An open scene of pours; `camera` is the same for all of them."""

    scene: Scene
    cup_id: int | None
    camera: Camera

    def shoot(self, replay: Replay, moment: int, width: int, height: int) -> Picture:
        """Take the picture (height, width, 3) of a recorded moment of a pour."""
        recording = replay.recording
        if self.cup_id is not None:
            self.scene.move_mesh(self.cup_id, recording.T_world_body[moment])
        self.scene.move_candies(recording.positions_m[moment], recording.quaternions[moment], replay.retained)
        return self.scene.photograph(self.camera, width, height)


@contextmanager
def open_pours(
    folder: Path,
    surface: TriangleMesh,
    cup: TriangleMesh | None,
    cup_poses: Sequence[FloatArray],
    parameters: Parameters,
    aspect: float,
    with_egl: bool,
) -> Iterator[PourView]:
    """Open the scene of pours whose cup is at `cup_poses` (4, 4); `folder` takes temporary files."""
    aabb = np.array([surface.aabb_min_m, surface.aabb_max_m])
    points = [aabb_corners(*aabb)]
    with Scene(folder, aabb, with_egl) as scene:
        scene.add_ground(aabb[0, 2] - _GROUND_GAP_M)
        scene.add_mesh(surface, OBJECT_COLOR)
        # Any candy may turn out kept or lost, so there are enough of both colours.
        scene.add_candies(parameters.particle, parameters.pouring.n_pour, parameters.pouring.n_pour)
        cup_id = None
        if cup is not None:
            cup_id = scene.add_cup(cup)
            points += [transform_points(pose, cup.vertices_m) for pose in cup_poses]
        yield PourView(scene, cup_id, frame(np.vstack(points), scene.forward, aspect))


def pour_replay(
    recording: Recording, surface: TriangleMesh, aabb_m: FloatArray, parameters: Parameters
) -> Replay:
    """Prepare a pour's recording; `aabb_m` (2, 3) is the one its candies were counted in."""
    retained = poured_in(recording, aabb_m, parameters.pouring.counted)
    ground_m = float(surface.aabb_min_m[2]) - _GROUND_GAP_M
    return make_replay(recording, retained, ground_m, particle_extents_m(parameters.particle))


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
            tile = reduced(view.shoot(replay, -1, SUPERSAMPLING * width, SUPERSAMPLING * height))
            is_chosen = choice is not None and (i, j) == (choice.i, choice.j)
            _paste(sheet, Image.fromarray(tile), *_place(i, j, *shape), _caption(grid, i, j), is_chosen)
        return Evidence({"pours.png": to_png(np.asarray(sheet))}, view.scene.renderer)


def _place(i: int, j: int, n_directions: int, n_indents: int) -> tuple[int, int]:
    """Row and column of a pour: the second half of the directions is to the right of the first."""
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
