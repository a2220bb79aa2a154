"""How well the imagination judges objects whose answer is known (Sec. IV-B, V-A)."""
