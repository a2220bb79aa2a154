"""Widgets that show plain data and emit signals; they know neither sessions nor jobs."""
