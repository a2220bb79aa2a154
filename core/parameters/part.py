"""Parts of the parameters: what a stage reads is all that it is handed."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TypeVar

from core.parameters.fields import Group

G = TypeVar("G", bound=Group)


def part_of(parameters: G, names: Iterable[str]) -> G:
    """Return a copy that holds only the parameters with these dotted names; to read another one is an error.

    The name of a group stands for all of it.

    It is of the same type, so that code which takes all parameters takes a part as well.

    Raises:
        AttributeError: on access of a parameter that is not among `names`.
    """
    return _part(parameters, frozenset(names), "")


def _part(group: G, names: frozenset[str], prefix: str) -> G:
    part = group.model_copy()
    for field, value in vars(group).items():
        name = prefix + field
        if name in names:
            continue
        if isinstance(value, Group) and any(known.startswith(f"{name}.") for known in names):
            part.__dict__[field] = _part(value, names, f"{name}.")
            continue
        # Deleted, not set to a default: a stage that reads what it does not declare shall fail, not lie.
        del part.__dict__[field]
    return part
