"""Where the arm can go: its kinematics, its clearance, clear ways, and camera views within reach."""
