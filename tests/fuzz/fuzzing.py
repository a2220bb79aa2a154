"""Feeds readers damaged input: each answers, or refuses with one short sentence; nothing else will do.

Run by `make fuzz`; `--inputs N` for another number than 10,000, `--target NAME` for one kind of input,
`--seed S` for one input. The seeds of what failed are written to `build/fuzz-failures.txt`.
"""

from __future__ import annotations

import argparse
import io
import signal
import sys
import tempfile
import time
import traceback
from collections import Counter
from collections.abc import Callable, Iterator
from contextlib import contextmanager, redirect_stderr, redirect_stdout
from dataclasses import dataclass, field
from pathlib import Path
from random import Random
from types import FrameType

from core.errors import PoursightError
from tests.fuzz.targets import TARGETS

INPUTS = 10_000
LONGEST_CALL_S = 20.0
LONGEST_SENTENCE = 300
FAILURES = Path("build/fuzz-failures.txt")


class Hang(BaseException):
    """A call took too long; no `except Exception` catches it."""


@dataclass
class Tally:
    """What came of the inputs.

    Attributes:
        calls: by target and result.
        failures: a text for each, which begins with the target and the seed.
    """

    calls: Counter[tuple[str, str]] = field(default_factory=Counter)
    failures: list[str] = field(default_factory=list)


def try_input(target: str, seed: int, base: Path, tally: Tally) -> None:
    """Make one input, and hand it to its readers."""
    pick = Random(f"{target} {seed}")
    with tempfile.TemporaryDirectory(prefix="f-") as place:
        for number, call in enumerate(TARGETS[target].calls(base, Path(place), pick)):
            failure, result = _outcome(call)
            tally.calls[target, result] += 1
            if failure:
                tally.failures.append(f"{target} {seed} (call {number}): {failure}")


def prepared(target: str, root: Path) -> Path:
    """Write what a target damages; return its folder."""
    base = root / target
    base.mkdir()
    TARGETS[target].prepare(base)
    return base


def _outcome(call: Callable[[], object]) -> tuple[str, str]:
    """Return (what was wrong, or nothing; the result in a word)."""
    said = io.StringIO()
    try:
        with redirect_stderr(said), redirect_stdout(said), _watched():
            call()
    except PoursightError as error:
        return _wrong_sentence(str(error)), "refused"
    except Hang:
        return f"hang of {LONGEST_CALL_S:.0f} s", "hang"
    except Exception:
        return traceback.format_exc(limit=-4), "traceback"
    if "Traceback" in said.getvalue():
        return said.getvalue(), "printed traceback"
    return "", "read"


def _wrong_sentence(said: str) -> str:
    if len(said) > LONGEST_SENTENCE:
        return f"a sentence of {len(said)} characters: {said[:400]}"
    if "\n" in said or not said.endswith((".", "?")):
        return f"no sentence: {said!r}"
    return ""


@contextmanager
def _watched() -> Iterator[None]:
    def stop(number: int, frame: FrameType | None) -> None:
        raise Hang

    before = signal.signal(signal.SIGALRM, stop)
    signal.setitimer(signal.ITIMER_REAL, LONGEST_CALL_S)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0)
        signal.signal(signal.SIGALRM, before)


def main() -> None:
    """Fuzz, tell, keep the seeds of what failed; exit code 1 if anything did."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--inputs", type=int, default=INPUTS)
    parser.add_argument("--target", choices=list(TARGETS))
    parser.add_argument("--seed", type=int)
    options = parser.parse_args()
    targets = [options.target] if options.target else list(TARGETS)
    n_each = -(-options.inputs // len(targets))
    seeds = range(n_each) if options.seed is None else [options.seed]
    tally = Tally()
    with tempfile.TemporaryDirectory(prefix="f-") as root:
        for target in targets:
            started = time.monotonic()
            base = prepared(target, Path(root))
            for seed in seeds:
                try_input(target, seed, base, tally)
            results = {result: n for (name, result), n in sorted(tally.calls.items()) if name == target}
            print(
                f"{target}: {len(seeds)} inputs, {time.monotonic() - started:.0f} s, calls {results}",
                flush=True,
            )
    print(f"{len(seeds) * len(targets)} inputs, {tally.calls.total()} calls, {len(tally.failures)} failures")
    FAILURES.parent.mkdir(exist_ok=True)
    FAILURES.write_text("\n".join(tally.failures))
    sys.exit(bool(tally.failures))


if __name__ == "__main__":
    main()
