"""Widgets that show plain data and tell what was clicked; they know neither sessions nor jobs."""
