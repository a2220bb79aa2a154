"""Labelled objects judged, poured into and fitted to: core and hardware together, on one machine or many."""
