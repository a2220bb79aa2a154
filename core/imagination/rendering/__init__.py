"""Evidence pictures and films, made by replaying recordings; nothing is simulated here."""
