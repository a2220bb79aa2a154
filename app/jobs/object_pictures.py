"""Pictures of labelled objects, drawn in a process of their own: what reads meshes would hold up a window."""

from __future__ import annotations

from contextlib import suppress
from multiprocessing.connection import Connection

from core.errors import PoursightError
from core.evaluation.labels import LabelledObject
from core.progress import Reporter

DrawnPicture = tuple[str, tuple[int, int], bytes]
"""An object's name, width and height, and the picture's bytes, RGBA."""


def draw_objects(
    connection: Connection, objects: tuple[LabelledObject, ...], size_px: tuple[int, int]
) -> None:
    """Send a `DrawnPicture` of each object; one that cannot be read is left out: judging it says why."""
    from core.mesh_file import read_mesh
    from core.mesh_picture import shaded_picture

    with suppress(OSError):  # nobody listens any more
        for one in objects:
            with suppress(PoursightError):
                picture = shaded_picture(read_mesh(one.mesh, Reporter()), size_px).convert("RGBA")
                connection.send((one.name, picture.size, picture.tobytes()))
