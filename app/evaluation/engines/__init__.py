"""Where trials are computed: worker processes on this machine, or a Dask cluster. The results are alike."""
