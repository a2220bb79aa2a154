"""The History page: earlier sessions to look at, open, compare, export and delete."""
