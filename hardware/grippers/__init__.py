"""Grippers."""
