"""The two imaginations of the paper: open containability (Sec. III-A) and pouring (Sec. III-B)."""
