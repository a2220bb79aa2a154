"""Damage that knows the structure of what it damages; the same generator gives the same damage."""

from __future__ import annotations

import json
import os
from collections.abc import Callable, Sequence
from io import BytesIO
from pathlib import Path
from random import Random
from typing import Any

import numpy as np

ODD_VALUES: tuple[Any, ...] = (
    None,
    True,
    0,
    -1,
    5,
    10**30,
    0.5,
    -1e300,
    1e300,
    "",
    "x",
    "é\n\t\x01",
    "x" * 5000,
    [],
    [1],
    [[]],
    [None],
    {},
    {"x": 1},
    [[1, 2], [3]],
)
ODD_NUMBERS = (
    "",
    "nan",
    "inf",
    "-inf",
    "1e300",
    "-1e300",
    "1e-300",
    "1e999",
    "0",
    "-1",
    "99999999999",
    "0x1",
    "1,5",
    "x",
)
ODD_WORDS = (
    "",
    '"',
    ",",
    ";",
    "\0",
    "é",
    "\ud7ff",
    "x" * 4000,
    "../..",
    "/etc/passwd",
    "=1+1",
    "\n",
    "\r",
    "true",
    "[",
    "{",
)
_NESTED = 100_000


def damaged_bytes(content: bytes, pick: Random) -> bytes:
    """Cut, flip, doubled, emptied, of another encoding: what happens to any file."""
    kind = pick.randrange(9)
    if kind == 0:
        return content[: pick.randrange(len(content) + 1)]
    if kind == 1:
        return _flipped(content, pick, pick.choice((1, 1, 2, 8, 64)))
    if kind == 2:
        start = pick.randrange(len(content) + 1)
        return content[:start] + content[start + pick.randrange(1, 200) :]
    if kind == 3:
        start = pick.randrange(len(content) + 1)
        return content[:start] + pick.randbytes(pick.randrange(1, 64)) + content[start:]
    if kind == 4:
        start = pick.randrange(len(content) + 1)
        return content[:start] + bytes(pick.randrange(1, 200)) + content[start + 100 :]
    if kind == 5:
        return content + content
    if kind == 6:
        return b""
    if kind == 7:
        return content.decode("latin-1").encode("utf-16")
    return b"\xef\xbb\xbf" + content


def _flipped(content: bytes, pick: Random, n: int) -> bytes:
    changed = bytearray(content)
    for _ in range(n if changed else 0):
        changed[pick.randrange(len(changed))] ^= 1 << pick.randrange(8)
    return bytes(changed)


def damaged_json(content: bytes, pick: Random) -> bytes:
    """Valid JSON with other keys, types and sizes, or text that is nearly JSON."""
    kind = pick.randrange(12)
    if kind == 0:
        return pick.choice((b"[", b'{"a":')) * _NESTED
    if kind == 1:
        return damaged_bytes(content, pick)
    table = json.loads(content)
    if kind == 2:
        return _with_number(table, pick)
    if kind == 3:
        table = pick.choice(ODD_VALUES)
    else:
        for _ in range(pick.choice((1, 1, 1, 2, 4))):
            table = _damaged_value(table, pick)
    return json.dumps(table, ensure_ascii=pick.random() < 0.5).encode("utf-8", "surrogatepass")


def _with_number(table: Any, pick: Random) -> bytes:
    """Put a number there that JSON has no word for."""
    text = json.dumps(_damaged_value(table, pick, "@"))
    return text.replace(
        '"@"', pick.choice(("NaN", "Infinity", "-1e999", "1" * 5000, "1e", '"\\ud800"'))
    ).encode()


def _damaged_value(value: Any, pick: Random, put: Any = ODD_VALUES) -> Any:
    """Go down a random way and damage what is found there."""
    if isinstance(value, dict) and value and pick.random() < 0.9:
        return _damaged_table(dict(value), pick, put)
    if isinstance(value, list) and value and pick.random() < 0.8:
        return _damaged_list(list(value), pick, put)
    return pick.choice(put)


def _damaged_table(table: dict[str, Any], pick: Random, put: Any) -> dict[str, Any]:
    key = pick.choice(list(table))
    kind = pick.randrange(8) if put is ODD_VALUES else 7
    if kind == 0:
        del table[key]
    elif kind == 1:
        table[f"{key}_of_tomorrow"] = pick.choice(ODD_VALUES)
    elif kind == 2:
        table[pick.choice(ODD_WORDS)] = table.pop(key)
    else:
        table[key] = _damaged_value(table[key], pick, put)
    return table


def _damaged_list(values: list[Any], pick: Random, put: Any) -> list[Any]:
    index = pick.randrange(len(values))
    kind = pick.randrange(6) if put is ODD_VALUES else 5
    if kind == 0:
        del values[index]
    elif kind == 1:
        values.insert(index, values[index])
    elif kind == 2:
        values.clear()
    else:
        values[index] = _damaged_value(values[index], pick, put)
    return values


def damaged_lines(content: bytes, pick: Random, odd: Sequence[str] = ODD_NUMBERS + ODD_WORDS) -> bytes:
    """Text of lines and words: words exchanged, lines moved, doubled, shortened, lengthened."""
    if pick.random() < 0.15:
        return damaged_bytes(content, pick)
    lines = content.decode("utf-8").split("\n")
    for _ in range(pick.choice((1, 1, 2, 5))):
        index = pick.randrange(len(lines))
        lines[index : index + 1] = _damaged_line(lines[index], pick, odd)
        lines = lines or [""]
    return "\n".join(lines).encode(pick.choice(("utf-8", "utf-8", "utf-8", "latin-1", "utf-16")), "replace")


def _damaged_line(line: str, pick: Random, odd: Sequence[str]) -> list[str]:
    kind = pick.randrange(7)
    if kind == 0:
        return []
    if kind == 1:
        return [line, line]
    if kind == 2:
        return [pick.choice(odd)]
    sign = "," if "," in line else None
    words = line.split(sign)
    index = pick.randrange(len(words) + 1)
    if kind == 3:
        words = words[:index]
    elif kind == 4:
        words.insert(index, pick.choice(odd))
    elif words:
        words[index % len(words)] = pick.choice(odd)
    return [(sign or " ").join(words)]


def damaged_arrays(content: bytes, pick: Random) -> bytes:
    """An NPZ with arrays left out, of other kinds and shapes, not finite, or out of range."""
    if pick.random() < 0.2:
        return damaged_bytes(content, pick)
    with np.load(BytesIO(content)) as archive:
        arrays: dict[str, Any] = {name: archive[name] for name in archive.files}
    name = pick.choice(list(arrays))
    changes: tuple[Callable[[Any], Any], ...] = (
        lambda a: a[:0],
        lambda a: a[:-1],
        lambda a: np.concatenate([a, a]) if a.ndim else a,
        lambda a: a.reshape(-1),
        lambda a: a[None],
        lambda a: a.astype("U8"),
        lambda a: a.astype(complex),
        lambda a: a.astype(np.float64) * np.nan,
        lambda a: a.astype(np.float64) * 1e300,
        lambda a: a.astype(np.int64) - 10**9,
        lambda a: a.astype(np.int64) + 10**9,
        lambda a: np.array(5),
        lambda a: np.zeros_like(a),
    )
    if pick.random() < 0.15:
        arrays[f"{name}_of_tomorrow"] = arrays.pop(name)
    else:
        arrays[name] = pick.choice(changes)(arrays[name])
    buffer = BytesIO()
    np.savez_compressed(buffer, **arrays)
    return buffer.getvalue()


def replaced(path: Path, pick: Random) -> bool:
    """Now and then put something else in the file's place: nothing, a folder, a pipe, a device or a link."""
    if pick.random() > 0.06:
        return False
    path.unlink()
    kind = pick.randrange(5)
    if kind == 1:
        path.mkdir()
    elif kind == 2:
        os.mkfifo(path)
    elif kind == 3:
        path.symlink_to("/dev/zero")
    elif kind == 4:
        path.symlink_to(path.parent / "nowhere")
    return True
