"""A UR controller on loopback: what ur_rtde's clients see of a real one, with faults on command."""
