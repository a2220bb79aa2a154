"""The pours: 24 imagined ones on a map and in 3D, the chosen one and why, and what else could be chosen."""
