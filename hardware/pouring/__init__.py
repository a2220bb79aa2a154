"""Carrying out a planned pour: confirm, check, move, watch, stop, recover, and keep all of it."""
