"""Executing a planned pour: check, move, watch, stop, recover, and log all of it."""
