"""All parameters together."""

from __future__ import annotations

from core.parameters.bodies import ParticleParameters, SolverParameters
from core.parameters.fields import OURS, Group, quantity
from core.parameters.imagination import (
    CapacityParameters,
    ContainabilityParameters,
    EvidenceParameters,
    PouringParameters,
    RetentionParameters,
)
from core.parameters.reconstruction import CollisionParameters, ReconstructionParameters
from core.parameters.risk import RiskParameters


class Parameters(Group):
    """Everything that decides a result, one group for each stage and two that stages share."""

    seed: int = quantity(0, "Seed of all randomness.", unit="", source=OURS, low=0, high=2**31 - 1)
    reconstruction: ReconstructionParameters = ReconstructionParameters()
    collision: CollisionParameters = CollisionParameters()
    particle: ParticleParameters = ParticleParameters()
    solver: SolverParameters = SolverParameters()
    containability: ContainabilityParameters = ContainabilityParameters()
    pouring: PouringParameters = PouringParameters()
    capacity: CapacityParameters = CapacityParameters()
    holding: RetentionParameters = RetentionParameters()
    risk: RiskParameters = RiskParameters()
    evidence: EvidenceParameters = EvidenceParameters()
