"""Where the data lies that the program ships."""

from pathlib import Path

RESOURCES = Path(__file__).resolve().parents[1] / "resources"
