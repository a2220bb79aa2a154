"""Devices, real and simulated side by side; knows no Qt."""
