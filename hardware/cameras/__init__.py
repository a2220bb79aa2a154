"""Real cameras and recordings of them; each brings in its driver only when it is connected."""
