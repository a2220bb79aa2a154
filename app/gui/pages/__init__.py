"""One folder a page. A page shows what the session holds and starts jobs; it computes nothing."""
