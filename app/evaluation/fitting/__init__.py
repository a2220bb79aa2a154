"""Calibration: labelled objects and measured spills in, a preset with its provenance out."""
