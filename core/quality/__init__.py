"""Is a scan good enough, what did it not see, and where to look again."""
