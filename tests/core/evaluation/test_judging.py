"""An object is judged in a worker by what decides, and what goes wrong is part of its verdict."""

from __future__ import annotations

from pathlib import Path

import pytest

from core.evaluation import judging
from core.evaluation.labels import LabelledObject
from core.evaluation.verdicts import ObjectVerdict
from core.mesh_file import write_ply
from core.parameters import Parameters, apply_settings
from hardware.simulation.objects import builtin_object
from tests.core.evaluation.few_candies import FEW_CANDIES

FEW = FEW_CANDIES | {"containability.rotation_s": 0.5, "collision.method": "exact"}


def verdict_of(tmp_path: Path, kind: str) -> ObjectVerdict:
    mesh, file = tmp_path / "bowl.ply", tmp_path / "bowl.json"
    write_ply(mesh, builtin_object("bowl"))
    parameters = apply_settings(Parameters(), FEW | {"containability.verdict": kind})
    judging.judge_object(LabelledObject("bowl", "container", mesh), parameters, file)
    verdict = ObjectVerdict.load(file)
    assert verdict is not None
    return verdict


def test_a_bowl_is_filled_where_that_decides(tmp_path: Path) -> None:
    by_omega, by_capacity = (verdict_of(tmp_path, kind) for kind in ("omega", "capacity"))
    assert (by_omega.measure, by_omega.capacity_share) == ("Omega", None)
    assert by_capacity.measure == "Capacity share"
    assert by_capacity.omega == by_omega.omega, "the same drop"
    assert by_capacity.score is not None and 0.4 < by_capacity.score < 1


def test_without_its_capacity_it_is_not_judged_by_omega_instead(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def fail(*_: object) -> float:
        raise RuntimeError("no filling today")

    monkeypatch.setattr(judging, "capacity_share", fail)
    verdict = verdict_of(tmp_path, "capacity")
    assert verdict.score is None and verdict.omega is None
    assert "no filling today" in verdict.problem
