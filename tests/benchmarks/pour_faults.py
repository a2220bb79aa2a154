"""Every kind of fault in approach, carry, pour, scan and back-off, with the real driver: `make pour-faults`.

The fault comes while the simulated controller keeps the real pace; what leads to it and what follows is
hurried. After each: how long until the arm stood and until it was said, what was said, whether anything went
on by itself, and whether the arm recovered, backed off, and made a whole pour. Ends with the table of
docs/pouring.md. Exit code 1 when anything was not as promised, or nothing was tried.

`--versions`, `--kinds` and `--phases` choose a part of it; what time does not allow for is named at the end.
"""

from __future__ import annotations

import argparse
import random
import sys
import tempfile
import time
from collections import defaultdict
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from tests.hardware.pouring.fault_bed import Row

ALL = 5
VERSIONS = ("3.15", "5.11")
"""A CB3 at 125 Hz and an e-Series at 500 Hz."""


def main() -> None:
    # Late: each driver that is started imports this module anew.
    from tests.hardware.pouring.fault_bed import HURRIED, KINDS, PHASES, Bed, Row, try_one
    from tests.hardware.pouring.rig import Rig

    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--kinds", nargs="*", choices=list(KINDS), default=list(KINDS))
    parser.add_argument("--phases", nargs="*", choices=PHASES, default=list(PHASES))
    parser.add_argument("--versions", nargs="*", choices=VERSIONS, default=list(VERSIONS))
    parser.add_argument(
        "--minutes", type=float, default=14.0, help="of each version; begin nothing afterwards"
    )
    parser.add_argument("--seed", type=int, default=0, help="of the order")
    args = parser.parse_args()
    cases = [(name, phase) for name in args.kinds for phase in args.phases if phase in KINDS[name].phases]
    random.Random(args.seed).shuffle(cases)
    n_failures = 0
    for version in args.versions:
        began_s, rows, left = time.monotonic(), defaultdict[str, Row](Row), list(cases)
        with tempfile.TemporaryDirectory() as folder, Rig(Path(folder), HURRIED, version) as rig:
            bed = Bed(rig, Path(folder))
            while left and time.monotonic() - began_s < 60 * args.minutes:
                name, phase = left.pop()
                try_one(bed, name, phase, rows[name])
        print(f"\nController {version}, {time.monotonic() - began_s:.0f} s\n")
        n_failures += told(rows, left)
    sys.exit(bool(n_failures) or not cases)


def told(rows: dict[str, Row], left: list[tuple[str, str]]) -> int:
    """Print the table, what was left, and what failed; return how many did."""
    print("| fault | in | stood after | said after | what is said | poured afterwards |")
    print("|---|---|---|---|---|---|")
    for name, row in sorted(rows.items()):
        print(table_row(name, row))
    print("\nNot begun in time:", ", ".join(f"{name} in {phase}" for name, phase in left) or "none")
    failures = [failure for row in rows.values() for failure in row.failures]
    print(
        f"{len(failures)} of {sum(row.n_tried for row in rows.values())} not as promised", *failures, sep="\n"
    )
    return len(failures)


def table_row(name: str, row: Row) -> str:
    """Of the table in docs/pouring.md."""
    phases = "all" if len(row.said) == ALL else ", ".join(row.said)
    said = max(set(row.said.values()), key=list(row.said.values()).count) if row.said else ""
    return (
        f"| {name} | {phases} | {_most(row.rested_s)} | {_most(row.said_s)} | {said.split(';')[0]} | "
        f"{row.n_poured} of {row.n_tried} |"
    )


def _most(seconds: list[float]) -> str:
    return f"{max(seconds):.2f} s" if seconds else ""


if __name__ == "__main__":
    main()
