"""All parameters together."""

from __future__ import annotations

from core.parameters.capacity import CapacityParameters
from core.parameters.fields import OURS, Group, quantity
from core.parameters.holding import HoldingParameters
from core.parameters.imagination import (
    ContainabilityParameters,
    EvidenceParameters,
    ParticleParameters,
    PouringParameters,
    SolverParameters,
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
    holding: HoldingParameters = HoldingParameters()
    risk: RiskParameters = RiskParameters()
    evidence: EvidenceParameters = EvidenceParameters()
