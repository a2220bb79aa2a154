"""Where the arm can go: its kinematics, its clearance, clear paths, and the camera views it can reach."""
