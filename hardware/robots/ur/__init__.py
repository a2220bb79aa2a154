"""A real UR5 or UR5e, driven through ur_rtde in a process of its own."""
