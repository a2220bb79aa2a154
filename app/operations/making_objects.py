"""Labelled objects made by code, in a folder that an evaluation reads.

meshes/NAME.ply  each object, in metres, z up, resting on z = 0
labels.csv       its label, and what is true of it
members.json     how they were made, and the same truth for programs
"""

from __future__ import annotations

import csv
import io
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

from core.errors import InputError
from core.evaluation.labels import MESHES_FOLDER
from core.files import make_folder, write_json, write_whole
from core.mesh_file import write_ply
from core.progress import Reporter
from core.session import explained
from hardware.simulation.families.catalogue import Family, Member, members

LABELS_FILE, MEMBERS_FILE = "labels.csv", "members.json"
STAGE = "objects"


def make_objects(folder: Path, families: Sequence[Family], n: int, seed: int, reporter: Reporter) -> None:
    """Write `n` members, of each family in turn; the same arguments give the same bytes.

    Raises:
        InputError: the folder holds something already, or cannot be one.
        SessionError: the disk is full or the folder may not be written.
        Cancelled: on request; the folder has no labels then.
    """
    rows = []
    with explained(folder):
        make_folder(folder)
        if any(folder.iterdir()):
            raise InputError(f"{folder} holds something already; name a new folder for the objects.")
        (folder / MESHES_FOLDER).mkdir()
        for done, one in enumerate(members(families, n, seed)):
            reporter.raise_if_cancelled()
            reporter.progress(STAGE, done, n)
            write_ply(folder / MESHES_FOLDER / f"{one.name}.ply", one.mesh)
            rows.append(_row(one))
        made = {"seed": seed, "families": [one.name for one in families], "members": rows}
        write_json(folder / MEMBERS_FILE, made)
        write_whole(folder / LABELS_FILE, _csv(rows))
    reporter.progress(STAGE, n, n)


def _row(one: Member) -> dict[str, Any]:
    truth = asdict(one.truth)
    label, reason = truth.pop("label"), truth.pop("reason")
    family = {"category": one.family.name, "half": one.family.half}
    return {"id": one.name, "label": label, **family, **truth, "notes": reason}


def _csv(rows: Sequence[dict[str, Any]]) -> str:
    out = io.StringIO()
    writer = csv.DictWriter(out, list(rows[0]), lineterminator="\n")
    writer.writeheader()
    writer.writerows(rows)
    return out.getvalue()
