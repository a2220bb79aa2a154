"""JSON of any origin, and how much of a strange file may stand in a sentence."""

from __future__ import annotations

from typing import Any

from pydantic_core import from_json

LONGEST_EXCERPT = 120


def excerpt(content: object) -> str:
    """Return what a sentence may show of content that others wrote: one line, 120 characters at most."""
    text = content if isinstance(content, str) else str(content)
    # Cut first: the content may be a whole file.
    words = " ".join(text[: 2 * LONGEST_EXCERPT].split())
    line = "".join(sign if sign.isprintable() else "?" for sign in words)
    is_whole = len(text) <= 2 * LONGEST_EXCERPT and len(line) <= LONGEST_EXCERPT
    return line if is_whole else f"{line[: LONGEST_EXCERPT - 3]}..."


def is_text(text: str) -> bool:
    """Whether it can be written as UTF-8: the names of files need not be text."""
    try:
        text.encode()
    except UnicodeEncodeError:
        return False
    return True


def parse_json(content: bytes) -> Any:
    """Parse JSON.

    Raises:
        ValueError: it is not UTF-8 or no JSON, nested deeply, or holds NaN, infinity or half a character.
    """
    return from_json(content, allow_inf_nan=False)
