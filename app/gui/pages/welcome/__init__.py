"""What is shown before a session is open."""
