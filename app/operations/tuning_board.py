"""What is kept of tuning: which objects, which sets of parameters, and every verdict. No Qt here.

It lies in the user's data folder: one folder for each folder of objects, in it `sets.json` and, for each set
of parameters that decides the score, a folder with one file a verdict.
"""

from __future__ import annotations

import csv
import hashlib
import io
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from string import ascii_uppercase
from typing import Any

from platformdirs import user_data_path

from app.library.places import APPLICATION
from core.errors import PoursightError
from core.evaluation.fitting.provenance import Provenance
from core.evaluation.labels import LabelledObject, read_labels
from core.evaluation.trials import Measure, measure_word
from core.evaluation.verdicts import ObjectVerdict, Score, is_right, judging_key, measure_by, mesh_mark, score
from core.files import read_json, write_json
from core.parameters import Parameters, apply_settings, difference
from core.session import explained

SETS_FILE, LAST_FILE = "sets.json", "last.json"


@dataclass(frozen=True)
class ParameterSet:
    """A column of the table.

    Attributes:
        name: such as "Set A".
        parameters: by which it judges.
        named: dotted names of those that were fitted; empty if none was.
        provenance: where fitted ones come from; none of those that somebody chose.
    """

    name: str
    parameters: Parameters
    named: tuple[str, ...] = ()
    provenance: Provenance | None = None

    @property
    def key(self) -> str:
        """What its verdicts are kept under."""
        return judging_key(self.parameters)

    @property
    def measure(self) -> Measure:
        """What it judges by."""
        return measure_by(self.parameters)

    @property
    def threshold(self) -> float:
        """Of what it judges by."""
        return self.parameters.containability.deciding_threshold


@dataclass(frozen=True)
class Board:
    """One folder of objects with everything that was found about them.

    Attributes:
        source: the folder of the objects.
        objects: all of them.
        sets: the columns, the oldest first.
        verdicts: by the sets' keys, then by the objects' names.
    """

    source: Path
    objects: tuple[LabelledObject, ...]
    sets: tuple[ParameterSet, ...] = ()
    verdicts: Mapping[str, Mapping[str, ObjectVerdict]] = field(default_factory=dict)

    @property
    def folder(self) -> Path:
        """Where it is kept."""
        name = hashlib.sha256(str(self.source.resolve()).encode()).hexdigest()[:16]
        return tuning_folder() / name

    def verdicts_folder(self, one: ParameterSet) -> Path:
        """Where the verdicts of a set are kept."""
        return self.folder / one.key

    def of(self, one: ParameterSet) -> Mapping[str, ObjectVerdict]:
        """Return a set's verdicts by the objects' names."""
        return self.verdicts.get(one.key, {})

    def score(self, one: ParameterSet) -> Score:
        """Sum up a set."""
        return score(self.objects, self.of(one), one.threshold)

    def undecided(self, one: ParameterSet) -> tuple[LabelledObject, ...]:
        """Return the objects that have no score by a set yet."""
        found = self.of(one)
        return tuple(
            each for each in self.objects if each.name not in found or found[each.name].score is None
        )

    def set_of(self, parameters: Parameters) -> ParameterSet | None:
        """Return the set with these parameters, as far as they are judged by."""
        wanted = judging_key(parameters), parameters.containability.deciding_threshold
        return next((one for one in self.sets if (one.key, one.threshold) == wanted), None)

    def with_set(self, parameters: Parameters) -> tuple[Board, ParameterSet]:
        """Return a board that has a set with these parameters, and that set."""
        known = self.set_of(parameters)
        if known is not None:
            return self, known
        new = ParameterSet(self._free_name(), parameters)
        return replace(self, sets=(*self.sets, new)), new

    def with_fitted_set(
        self, parameters: Parameters, named: tuple[str, ...], provenance: Provenance
    ) -> tuple[Board, ParameterSet]:
        """Return a board whose set with these parameters says where they come from, and that set."""
        board, plain_set = self.with_set(parameters)
        fitted = replace(plain_set, parameters=parameters, named=named, provenance=provenance)
        sets = tuple(fitted if one == plain_set else one for one in board.sets)
        return replace(board, sets=sets), fitted

    def without_set(self, name: str) -> Board:
        """Return a board without a column; its verdicts stay on the disk."""
        return replace(self, sets=tuple(one for one in self.sets if one.name != name))

    def with_verdict(self, key: str, verdict: ObjectVerdict) -> Board:
        """Return a board that knows one more verdict."""
        found = {**self.verdicts.get(key, {}), verdict.name: verdict}
        return replace(self, verdicts={**self.verdicts, key: found})

    def _free_name(self) -> str:
        taken = {one.name for one in self.sets}
        letters = (f"Set {letter}" for letter in ascii_uppercase)
        return next((name for name in letters if name not in taken), f"Set {len(taken) + 1}")


def verdict_file(folder: Path, name: str) -> Path:
    """Return the file of an object's verdict."""
    return folder / f"{name}.json"


def tuning_folder() -> Path:
    """Return the folder of all boards; it need not exist yet."""
    return user_data_path(APPLICATION, appauthor=False) / "calibration"


def load_board(source: Path) -> Board:
    """Read the objects of a folder, and what was found about them before.

    Raises:
        InputError: the folder has no labels that can be used.
    """
    board = Board(source, read_labels(source))
    sets = tuple(_sets(board.folder / SETS_FILE))
    board = replace(board, sets=sets)
    return read_verdicts(board)


def read_verdicts(board: Board) -> Board:
    """Read the verdicts of all sets anew; one of a mesh that has changed since does not count."""
    marks = {one.name: mesh_mark(one.mesh) for one in board.objects}
    verdicts = {one.key: _verdicts(board.verdicts_folder(one), marks) for one in board.sets}
    return replace(board, verdicts=verdicts)


def save_board(board: Board) -> None:
    """Keep the sets, and that this board was the last.

    Raises:
        SessionError: the user's data folder cannot be written.
    """
    sets = [_table(one) for one in board.sets]
    with explained(board.folder):
        board.folder.mkdir(parents=True, exist_ok=True)
        write_json(board.folder / SETS_FILE, {"objects": str(board.source), "sets": sets})
        write_json(tuning_folder() / LAST_FILE, {"objects": str(board.source)})


def last_source() -> Path | None:
    """Return the folder of objects that was worked with last; none if it has gone."""
    try:
        source = Path(str(read_json(tuning_folder() / LAST_FILE)["objects"]))
    except (PoursightError, KeyError):
        return None
    return source if source.is_dir() else None


def csv_text(board: Board) -> str:
    """Return the table: id, label, category, then for each set Omega, what decides, whether it is right."""
    out = io.StringIO()
    writer = csv.writer(out)
    heads = [f"{one.name} {head}" for one in board.sets for head in _heads(one)]
    writer.writerow(["id", "label", "category", *heads])
    for each in board.objects:
        row: list[object] = [each.name, each.label, each.category]
        for one in board.sets:
            row += _values(board, one, each)
        writer.writerow(row)
    return out.getvalue()


def _heads(one: ParameterSet) -> tuple[str, ...]:
    return ("omega", "right") if one.measure == "Omega" else ("omega", measure_word(one.measure), "right")


def _values(board: Board, one: ParameterSet, each: LabelledObject) -> list[object]:
    """The cells below `_heads` for an object; empty what is not known."""
    verdict = board.of(one).get(each.name)
    if verdict is None or verdict.score is None:
        return [""] * len(_heads(one))
    right = is_right(each.label, verdict.score, one.threshold)
    scores = [verdict.omega] if one.measure == "Omega" else [verdict.omega, verdict.score]
    return [*scores, "" if right is None else int(right)]


def _table(one: ParameterSet) -> dict[str, object]:
    table: dict[str, object] = {"name": one.name, "parameters": _changes(one.parameters)}
    if one.provenance is not None:
        table |= {"named": list(one.named), "provenance": one.provenance.to_table()}
    return table


def _set(row: Mapping[str, Any]) -> ParameterSet:
    parameters = apply_settings(Parameters(), row["parameters"])
    provenance = row.get("provenance")
    return ParameterSet(
        str(row["name"]),
        parameters,
        tuple(row.get("named", ())),
        None if provenance is None else Provenance.from_table(provenance),
    )


def _changes(parameters: Parameters) -> dict[str, object]:
    return {name: value for name, (_, value) in difference(parameters, Parameters()).items()}


def _sets(path: Path) -> list[ParameterSet]:
    """Read the sets; what an older or newer program cannot read any more is left out."""
    try:
        rows = read_json(path)["sets"]
    except (PoursightError, KeyError):
        return []
    found = []
    for row in rows:
        try:
            found.append(_set(row))
        except (PoursightError, KeyError, TypeError, AttributeError):
            continue
    return found


def _verdicts(folder: Path, marks: Mapping[str, str]) -> dict[str, ObjectVerdict]:
    found = {}
    for name, mark in marks.items():
        verdict = ObjectVerdict.load(verdict_file(folder, name))
        if verdict is not None and verdict.mesh == mark:
            found[name] = verdict
    return found
