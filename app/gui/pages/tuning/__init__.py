"""Tune: sets of parameters compared on objects whose answer is known, and fitted to them."""
