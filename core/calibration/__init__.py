"""Calibrating where the camera hangs at the arm: board, views, fit, accuracy, and poses worth taking."""
