"""Judging by looks: what the paper compares imagination with, by a network of our own (Sec. V)."""
