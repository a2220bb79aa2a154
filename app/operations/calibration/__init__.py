"""Setting a cell up: its file, its calibration board, where its camera hangs, and whether that is true."""
