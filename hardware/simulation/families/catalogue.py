"""All families by name, and their members."""

from __future__ import annotations

import difflib
import zlib
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Literal, get_args

import numpy as np

from core.errors import InputError
from core.formats import excerpt
from core.mesh import TriangleMesh
from hardware.simulation.families import bodies, boxes, pierced, turned_over, vessels
from hardware.simulation.families.forms import Draw
from hardware.simulation.families.truth import Form, Truth, truth_of

Half = Literal["development", "judging"]
HALVES: tuple[Half, ...] = get_args(Half)
_GOLDEN = (5**0.5 - 1) / 2
"""Steps of this size spread any number of members evenly."""


@dataclass(frozen=True)
class Family:
    """Objects of one kind.

    Attributes:
        name: unique.
        half: whether the program may be improved by looking at them, or is only judged by them.
        make: makes a member.
    """

    name: str
    half: Half
    make: Callable[[Draw], Form]


@dataclass(frozen=True)
class Member:
    """One object of a family.

    Attributes:
        name: unique: the family's, and its number.
        family: it belongs to.
        mesh: closed surfaces in metres, resting on z = 0, z up.
        truth: what is true of it.
    """

    name: str
    family: Family
    mesh: TriangleMesh
    truth: Truth


def _named(half: Half, *makers: Callable[[Draw], Form]) -> dict[str, Family]:
    return {make.__name__: Family(make.__name__, half, make) for make in makers}


FAMILIES: dict[str, Family] = _named(
    "development",
    *(vessels.cup, vessels.bowl, vessels.bottle, vessels.goblet, vessels.bucket, vessels.double_wall),
    *(boxes.open_box, boxes.broken_tray, boxes.muffin_tin, boxes.keyboard),
    *(pierced.sieve, pierced.funnel, pierced.tube),
    *(turned_over.lying, bodies.can, bodies.spoon, bodies.blob, bodies.closed),
) | _named(
    "judging",
    *(vessels.mug, vessels.plate, vessels.vase, vessels.urn, vessels.rough_pot),
    *(boxes.lidded_box, boxes.tray, boxes.compartments),
    *(pierced.basket, pierced.drain_pot, pierced.ring, pierced.gear),
    *(turned_over.tilted, turned_over.upside_down, bodies.lid, bodies.ladle, bodies.mug_in_tray),
)


def families_of(names: Sequence[str], half: Half | None) -> tuple[Family, ...]:
    """Return the families of these names (none: all) that are in a half (none: both).

    Raises:
        InputError: there is none of a name, or none is left.
    """
    for name in names:
        if name not in FAMILIES:
            said = excerpt(name)
            nearest = difflib.get_close_matches(said, FAMILIES, 1, 0)[0]
            raise InputError(
                f"There is no family '{said}'; did you mean '{nearest}'? docs/families.md names all."
            )
    chosen = [FAMILIES[name] for name in names or FAMILIES]
    kept = tuple(one for one in dict.fromkeys(chosen) if half in (None, one.half))
    if not kept:
        raise InputError(
            f"None of the families {excerpt(', '.join(names))} is for {half}; leave out one of the two."
        )
    return kept


def members(families: Sequence[Family], n: int, seed: int) -> Iterator[Member]:
    """Make `n` members, of each family in turn; a member depends on its number and the seed alone."""
    for index in range(n):
        number, place = divmod(index, len(families))
        yield member(families[place], number, seed)


def member(family: Family, number: int, seed: int) -> Member:
    """Make one member of a family."""
    key = zlib.crc32(family.name.encode())
    start = np.random.default_rng([seed, key]).random()
    draw = Draw((start + number * _GOLDEN) % 1, np.random.default_rng([seed, key, number]))
    form = family.make(draw)
    return Member(f"{family.name}-{number:03d}", family, form.mesh, truth_of(form))
