"""The Scan page: the arm takes the views, or a scan or a mesh comes from a file."""
