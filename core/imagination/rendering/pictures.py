"""Finished pictures: captions in the font that Pillow brings along (Latin letters, degree sign) and PNG."""

from __future__ import annotations

from functools import lru_cache
from io import BytesIO

import numpy as np
from PIL import Image, ImageDraw, ImageFont

from core.imagination.rendering.scene import KEPT_COLOR, LOST_COLOR, Picture

BAR_PX = 34
PICTURE_PX = (640, 480)
"""Width and height of a still and of a film, which must be even, with the caption."""
VIEW_PX = (PICTURE_PX[0], PICTURE_PX[1] - BAR_PX)
"""The same without the caption."""
SUPERSAMPLING = 2
"""How many times wider and higher a still is drawn before it is reduced."""
_TEXT_PX = 19
_TEXT_COLOR = (35, 35, 35)
_BAR_COLOR = (255, 255, 255)
_LEGEND = (("kept", KEPT_COLOR), ("lost", LOST_COLOR))


def with_caption(picture: Picture, text: str) -> Picture:
    """Return the picture (height, width, 3) with a bar of `BAR_PX` added below: text left, legend right."""
    return np.vstack([picture, caption_bar(picture.shape[1], text)])


@lru_cache(maxsize=32)
def caption_bar(width: int, text: str) -> Picture:
    """Return a bar (BAR_PX, width, 3) with text and the legend of the candies' colours."""
    bar = Image.new("RGB", (width, BAR_PX), _BAR_COLOR)
    draw = ImageDraw.Draw(bar)
    middle = BAR_PX // 2
    draw.text((12, middle), text, fill=_TEXT_COLOR, font=font(_TEXT_PX), anchor="lm")
    right = width - 12
    for word, color in reversed(_LEGEND):
        right -= round(draw.textlength(word, font=font(_TEXT_PX)))
        draw.text((right, middle), word, fill=_TEXT_COLOR, font=font(_TEXT_PX), anchor="lm")
        draw.ellipse((right - 19, middle - 6, right - 7, middle + 6), fill=rgb(color))
        right -= 34
    return np.asarray(bar)


def to_png(picture: Picture) -> bytes:
    """Return the picture as PNG."""
    file = BytesIO()
    Image.fromarray(picture).save(file, format="PNG")
    return file.getvalue()


def reduced(picture: Picture) -> Picture:
    """Halve a picture, which smooths its edges."""
    height, width = picture.shape[:2]
    blocks = picture.reshape(height // SUPERSAMPLING, SUPERSAMPLING, width // SUPERSAMPLING, SUPERSAMPLING, 3)
    smooth: Picture = (blocks.sum(axis=(1, 3), dtype=np.uint16) // SUPERSAMPLING**2).astype(np.uint8)
    return smooth


def font(size_px: int) -> ImageFont.FreeTypeFont | ImageFont.ImageFont:
    """Return the font at a size."""
    return ImageFont.load_default(size_px)


def rgb(color: tuple[float, float, float, float]) -> tuple[int, int, int]:
    """Return a colour of the scene as Pillow wants it."""
    red, green, blue = (round(255 * share) for share in color[:3])
    return red, green, blue
