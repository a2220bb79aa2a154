"""The robot's scan (Sec. IV-A): view by view, each on disk before the arm moves on."""
