"""Pictures and films made part of the page."""

from __future__ import annotations

import base64
from collections.abc import Mapping
from dataclasses import dataclass
from io import BytesIO

from core.files import read_content
from core.report.content import Media

_WIDE = 1.6
"""Width over height from which a picture gets a row of its own."""


@dataclass(frozen=True)
class Figure:
    """A picture or film on the page; without `uri` it is missing, and `missing` says why."""

    caption: str
    uri: str
    is_wide: bool = False
    missing: str = ""


def embed_pictures(pictures: Mapping[str, Media]) -> list[Figure]:
    """Embed pictures by their captions; one that cannot be used is marked as missing."""
    return [_embed_picture(caption, media) for caption, media in pictures.items()]


def embed_films(films: Mapping[str, Media]) -> list[Figure]:
    """Embed MP4 films by their captions."""
    return [_embed_film(caption, media) for caption, media in films.items()]


def data_uri(kind: str, content: bytes) -> str:
    """Return bytes as a data URI."""
    return f"data:{kind};base64,{base64.b64encode(content).decode('ascii')}"


def _embed_picture(caption: str, media: Media) -> Figure:
    from PIL import Image

    try:
        content = _read(media)
        with Image.open(BytesIO(content)) as image:
            kind, (width, height) = Image.MIME[image.format or ""], image.size
    except Exception as error:  # Pillow raises another kind for each way in which a picture can be damaged
        return _missing(caption, "picture", error)
    return Figure(caption, data_uri(kind, content), is_wide=width > _WIDE * height)


def _embed_film(caption: str, media: Media) -> Figure:
    try:
        return Figure(caption, data_uri("video/mp4", _read(media)))
    except OSError as error:
        return _missing(caption, "film", error)


def _missing(caption: str, what: str, error: Exception) -> Figure:
    reason = error.strerror if isinstance(error, OSError) and error.strerror else "it is damaged"
    return Figure(caption, "", missing=f"This {what} cannot be shown: {reason}.")


def _read(media: Media) -> bytes:
    return media if isinstance(media, bytes) else read_content(media)
