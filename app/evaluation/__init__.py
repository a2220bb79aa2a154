"""Judging and pouring many labelled objects: core and hardware together, on one machine or many."""
