"""A small picture of a session, stored in its folder: its coloured model, its evidence, its scan or its mesh.

Heavy imports come late: a list of sessions only asks whether there is a picture.
"""

from __future__ import annotations

from collections.abc import Mapping
from io import BytesIO
from pathlib import Path
from typing import TYPE_CHECKING

from app.library.session_folder import THUMBNAIL_FILE
from core.errors import SessionError
from core.files import read_content
from core.pipeline.session_view import current_records
from core.session import StageRecord, explained

if TYPE_CHECKING:
    from PIL.Image import Image

SIZE_PX = (320, 240)
_END_STILL = "drop_6_end.png"
_SCAN_SHARE = 0.6
"""Share of a scan's picture that is shown: the views look at the object's middle, from a distance."""


def current_thumbnail(session: Path, records: Mapping[str, StageRecord] | None = None) -> Path | None:
    """Return the picture if there is one and it is not older than what it shows.

    Args:
        session: its folder.
        records: `current_records(session)` if they are at hand.
    """
    source = _source(session, current_records(session) if records is None else records)
    picture = session / THUMBNAIL_FILE
    try:
        is_current = source is not None and picture.stat().st_mtime_ns >= source.stat().st_mtime_ns
    except OSError:
        return None
    return picture if is_current else None


def make_thumbnail(session: Path) -> Path | None:
    """Make a session's picture unless it is there; call it in a thread or worker, it takes 0.02 to 1 s.

    Returns:
        The picture (PNG, 320 x 240); None if the session holds nothing to show yet.

    Raises:
        SessionError: the picture's source is damaged, or the session's folder cannot be written.
    """
    session = session.absolute()
    records = current_records(session)
    source = _source(session, records)
    if source is None or current_thumbnail(session, records) is not None:
        return current_thumbnail(session, records)
    picture = _draw(source)
    unfinished = session / f"{THUMBNAIL_FILE}.part"
    with explained(session):
        try:
            picture.save(unfinished, "PNG")
            unfinished.replace(session / THUMBNAIL_FILE)
        finally:
            unfinished.unlink(missing_ok=True)
    return session / THUMBNAIL_FILE


def _source(session: Path, records: Mapping[str, StageRecord]) -> Path | None:
    if "colors" in records:
        return session / "colors" / "colors.npz"
    if "evidence" in records and _END_STILL in records["evidence"].files:
        return session / "evidence" / _END_STILL
    if "scan" in records:
        views = sorted(name for name in records["scan"].files if name.endswith(".color.png"))
        return session / "scan" / views[0] if views else None
    return session / "mesh" / "mesh.ply" if "mesh" in records else None


def _draw(source: Path) -> Image:
    from PIL import Image

    if source.suffix in (".ply", ".npz"):
        from core.mesh_file import read_ply
        from core.mesh_picture import shaded_picture
        from core.reconstruction.colors import ModelColors

        if source.suffix == ".ply":
            return shaded_picture(read_ply(source), SIZE_PX)
        mesh = read_ply(source.parents[1] / "reconstruction" / "mesh.ply")
        return shaded_picture(mesh, SIZE_PX, rgb=ModelColors.load(source.parent).rgb)
    try:
        with Image.open(BytesIO(read_content(source))) as picture:
            return _cropped(picture.convert("RGB"), source)
    except Exception as error:  # Pillow raises another kind for each way in which a picture can be damaged
        raise SessionError(f"{source} cannot be read; run the stage that writes it again.") from error


def _cropped(picture: Image, source: Path) -> Image:
    """Leave the evidence without its caption, and of a scan's view the middle; then to size."""
    from PIL import ImageOps

    from core.imagination.rendering.pictures import BAR_PX

    width, height = picture.size
    if source.name == _END_STILL:
        picture = picture.crop((0, 0, width, height - BAR_PX))
    else:
        left, top = round((1 - _SCAN_SHARE) / 2 * width), round((1 - _SCAN_SHARE) / 2 * height)
        picture = picture.crop((left, top, width - left, height - top))
    return ImageOps.fit(picture, SIZE_PX)
