"""Arms: the kinematic twin, and the arm of a recorded scan."""
