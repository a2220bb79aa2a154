"""The method of Wu & Chirikjian (RA-L 2020): pure, without Qt, hardware or global state."""
