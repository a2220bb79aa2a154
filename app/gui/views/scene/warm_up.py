"""Draws each kind of thing once unseen, so that the first page need not wait for the shaders of all views."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

import numpy as np

from app.gui.theme import LIGHT
from app.gui.views.scene.camera import Camera
from app.gui.views.scene.canvas import has_opengl
from app.gui.views.scene.ground import Ground
from app.gui.views.scene.layers import line_layer, mesh_layer, points_layer
from app.gui.views.scene.parts import prepare_mesh
from app.gui.views.scene.shapes import box_mesh
from app.gui.views.scene.snapshot import Snapshot

_SIZE = 32, 32


def warm_up(done: Callable[[], None]) -> None:
    """Draw in the drawing thread, then call `done` in the window's; at once where there is no OpenGL."""
    if not has_opengl():
        done()
        return
    from app.gui.views.scene.drawing_thread import drawing_thread
    from app.gui.views.scene.renderer import Renderer

    corners = np.array([(0.0, 0.0, 0.0), (1.0, 1.0, 1.0)])
    layers = (
        points_layer(corners, "accent", 8),
        line_layer(corners, "accent", 2),
        mesh_layer(prepare_mesh(*box_mesh(*corners)), "body", 1.0),
        Ground(corners[0], (1.0, 1.0), corners, grid_m=0.01, fades=True).layer,
    )
    snapshot = Snapshot(dict(enumerate(layers)), Camera(), LIGHT, _SIZE, 1.0, is_still=True)
    thread, renderer = drawing_thread(), Renderer()
    thread.run(partial(renderer.draw, snapshot=snapshot))
    thread.run_then(renderer.release, lambda _: done())
