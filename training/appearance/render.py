"""Render the examples into one file.

Usage: python -m training.appearance.render OUT.npz [--objects FOLDER] [--members N] [--seed S]
"""

from __future__ import annotations

import argparse
from collections.abc import Iterator
from itertools import chain
from pathlib import Path

import numpy as np

from core.errors import InputError
from training.appearance.examples import Subject, development_objects, examples_of, family_subjects

_VIEWS_OF_MEMBER = 8
_VIEWS_OF_OBJECT = 40
"""Of each development object: there are few of them."""


def render(out: Path, objects: Path, n_members: int, seed: int) -> None:
    """Render all subjects and write the arrays of `Example`, stacked, and what each row is of."""
    subjects: Iterator[tuple[Subject, int]] = chain(
        ((one, _VIEWS_OF_MEMBER) for one in family_subjects(n_members, seed)),
        ((one, _VIEWS_OF_OBJECT) for one in development_objects(objects)),
    )
    rows = []
    for subject, n_views in subjects:
        try:
            rows += [(subject, one) for one in examples_of(subject, n_views, seed)]
        except InputError as error:
            print(f"{subject.name} is left out: {error}", flush=True)
    out.parent.mkdir(parents=True, exist_ok=True)
    np.savez(
        out,
        color=np.array([one.color for _, one in rows]),
        nearness=np.array([one.nearness for _, one in rows]),
        contain=np.array([one.contain for _, one in rows]),
        name=np.array([subject.name for subject, _ in rows]),
        kind=np.array([subject.kind for subject, _ in rows]),
        is_container=np.array([subject.is_container for subject, _ in rows]),
        is_held_out=np.array([subject.is_held_out for subject, _ in rows]),
        seed=seed,
        n_members=n_members,
    )
    print(f"{len(rows)} views of {len({subject.name for subject, _ in rows})} objects: {out}")


def main() -> None:
    """Read the command line."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("out", type=Path)
    parser.add_argument("--objects", type=Path, default=Path("../shared/data/objects"))
    parser.add_argument("--members", type=int, default=1300)
    parser.add_argument("--seed", type=int, default=23)
    given = parser.parse_args()
    render(given.out, given.objects, given.members, given.seed)


if __name__ == "__main__":
    main()
