"""Threads for what leaves the interpreter to others while it computes: compiled loops, large NumPy calls."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from concurrent.futures import ThreadPoolExecutor
from typing import TypeVar

from core.workers import usable_processors

Item = TypeVar("Item")
Result = TypeVar("Result")


def in_threads(function: Callable[[Item], Result], items: Iterable[Item]) -> list[Result]:
    """Return a function's results in the order of the items, computed on all usable processors.

    Raises:
        Exception: whatever the first failing call raised.
    """
    with ThreadPoolExecutor(usable_processors()) as threads:
        return list(threads.map(function, items))
