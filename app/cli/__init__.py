"""The command line: everything the program does, without a window; imports nothing heavy."""

from app.cli.program import main

__all__ = ["main"]
