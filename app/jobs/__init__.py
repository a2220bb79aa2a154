"""Work outside the window's process: a host process carries out one job after the other (no Qt here)."""
