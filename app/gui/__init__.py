"""The desktop: the only place that knows Qt. It shows what is on the disk and asks processes to work."""
