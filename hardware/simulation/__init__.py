"""The simulated cell: objects, a depth camera that is as bad as the real one, and its scan."""
