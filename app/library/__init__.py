"""The sessions of this computer, found again: list, compare, export, delete (no Qt here)."""
