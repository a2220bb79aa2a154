"""From a scan or a mesh to a report: each stage run when it is stale, in workers, and kept in the session."""
