"""Calibration: labelled objects judged with several sets of parameters, side by side."""
