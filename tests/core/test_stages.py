"""The table of stages: every parameter makes stale what reads it and what follows, and nothing else."""

import pytest

from core.parameters import Parameters, apply_settings, describe, flatten
from core.parameters.fields import OURS, Group, quantity
from core.parameters.part import part_of
from core.pipeline.freshness import Freshness, freshness
from core.pipeline.running import RUNS
from core.session import Session
from core.stages import (
    GIVEN,
    MESH,
    STAGES,
    changed_settings,
    groups_of,
    recorded_settings,
    stage,
    stages_before,
    stages_of,
)

RECONSTRUCTION = ["reconstruction", "quality", "colors"]
JUDGED = ["judgement", "amount", "pouring", "risk"]
PHYSICS = ["containability", *JUDGED, "retention"]
POURS = ["pouring", "risk", "evidence"]
FIRST_STALE = {
    "seed": [*PHYSICS, "evidence"],
    "reconstruction": [*RECONSTRUCTION, "collision", *PHYSICS, "evidence"],
    "collision": ["collision", *PHYSICS, "evidence"],
    "collision.aabb_margin_m": [*PHYSICS, "evidence"],
    "particle": [*PHYSICS, "evidence"],
    "solver": [*PHYSICS, "evidence"],
    "containability": [*PHYSICS, "evidence"],
    "containability.verdict": [*JUDGED, "retention", "evidence"],
    "containability.capacity_threshold": [*JUDGED, "evidence"],
    "containability.omega_threshold": [*JUDGED, "evidence"],
    "capacity": [*JUDGED, "evidence"],
    "holding": ["retention"],
    "pouring": POURS,
    "pouring.amount": ["amount", *POURS],
    "pouring.n_pour": ["amount", *POURS],
    "pouring.cup": ["amount", *POURS],
    "risk": ["risk", "evidence"],
    "risk.candy_spread": ["amount", *POURS],
    "evidence": ["evidence"],
    "evidence.record_interval_s": [*PHYSICS, "evidence"],
}
"""By the longest name that a parameter begins with."""


def expected(name):
    parts = name.split(".")
    endings = (".".join(parts[:n]) for n in range(len(parts), 0, -1))
    return next(FIRST_STALE[known] for known in endings if known in FIRST_STALE)


def another(fact):
    """A value in the parameter's range that is not its default."""
    if fact.choices:
        return next(word for word in fact.choices if word != fact.default)
    if isinstance(fact.default, bool):
        return not fact.default
    if fact.name in ("reconstruction.crop_min_m", "reconstruction.crop_max_m"):
        return [-1.0] * 3 if fact.name.endswith("min_m") else [1.0] * 3
    if fact.default is None:
        return (fact.low + fact.high) / 2
    if isinstance(fact.default, int):
        return fact.default + 1 if fact.default < fact.high else fact.default - 1
    nearer = fact.default + 0.01 * (fact.high - fact.default)
    return nearer if nearer != fact.default else fact.default - 0.01 * (fact.default - fact.low)


def changed(name):
    """All default parameters but one, without the checks of parameters that belong together."""
    fact = next(one for one in describe() if one.name == name)
    parameters = Parameters()
    *groups, leaf = name.split(".")
    chain = [parameters]
    for group in groups:
        chain.append(getattr(chain[-1], group))
    value = chain[-1].model_copy(update={leaf: another(fact)})
    for holder, group in zip(reversed(chain[:-1]), reversed(groups), strict=True):
        value = holder.model_copy(update={group: value})
    return value


@pytest.fixture(scope="module")
def finished(tmp_path_factory):
    """A scanned session in which every stage is finished with the default parameters."""
    with Session.create_or_open(tmp_path_factory.mktemp("finished") / "session") as session:
        write(session, "scan", (), {})
        for one in stages_of("reconstruction"):
            write(session, one.name, one.inputs_of("reconstruction"), one.settings(Parameters()))
        yield session


def write(session, name, inputs, settings):
    digests = {before: session.record(before).digest for before in inputs}
    with session.writing(name, inputs=digests, parameters=settings) as folder:
        (folder / "result").write_text(name)


def stale(session, parameters):
    found = freshness(session, parameters)
    return [name for name, how in found.items() if how is Freshness.STALE]


def test_with_the_same_parameters_nothing_is_stale(finished):
    assert stale(finished, Parameters()) == []


@pytest.mark.parametrize("name", list(flatten(Parameters())))
def test_a_parameter_makes_stale_what_reads_it_and_what_follows(name, finished):
    parameters = changed(name)
    assert flatten(parameters)[name] != flatten(Parameters())[name]
    assert stale(finished, parameters) == expected(name)
    readers = [one.name for one in STAGES if name in one.settings(Parameters())]
    assert readers, "somebody must read it"
    for reader in readers:
        record = finished.record(reader)
        if record is not None:
            assert changed_settings(reader, record.parameters, parameters) == [name]


def test_a_stage_cannot_read_what_it_does_not_declare():
    part = stage("containability").part(Parameters())
    assert part.containability.n_max == Parameters().containability.n_max
    with pytest.raises(AttributeError):
        _ = part.pouring
    with pytest.raises(AttributeError):
        _ = part.containability.omega_threshold
    with pytest.raises(AttributeError):
        _ = part_of(part, ["seed"]).particle, "a part of a part"


def test_a_parameter_that_no_stage_declares_makes_all_of_them_stale():
    class NewGroup(Group):
        strength: float = quantity(1.0, "New.", unit="", source=OURS, low=0, high=2)

    class Extended(Parameters):
        new: NewGroup = NewGroup()

    for one in STAGES:
        assert one.settings(Extended())["new.strength"] == 1.0
        assert one.part(Extended()).new.strength == 1.0


def test_every_stage_of_the_table_runs_and_loads():
    assert set(RUNS) == {one.name for one in STAGES} | {MESH}


def test_no_stage_is_made_from_a_later_one():
    known = set(GIVEN)
    for one in STAGES:
        assert set(one.inputs_of("reconstruction")) <= known
        known.add(one.name)


def test_what_a_stage_is_made_from():
    assert stages_before("judgement", MESH) == (MESH, "collision", "containability", "judgement")
    assert groups_of("reconstruction") == ("reconstruction",)
    assert groups_of("amount", "risk") == ("seed", "particle", "solver", "pouring", "risk")


def test_records_of_earlier_versions_are_understood():
    """They held nested groups, and those of a stage's own group without its name."""
    table = Parameters().model_dump(mode="json")
    assert recorded_settings("reconstruction", table["reconstruction"]) == stage("reconstruction").settings(
        Parameters()
    )
    former = {
        name: table[name] for name in ("seed", "particle", "solver", "containability", "pouring", "risk")
    }
    former |= {"aabb_margin_m": 0.0, "record_interval_s": table["evidence"]["record_interval_s"]}
    assert changed_settings("containability", former, Parameters()) == []
    thicker = apply_settings(Parameters(), {"particle.height_m": 0.008})
    assert changed_settings("containability", former, thicker) == ["particle.height_m"]
    assert "capacity.n_real" in changed_settings("judgement", former, Parameters()), "nobody wrote it down"
