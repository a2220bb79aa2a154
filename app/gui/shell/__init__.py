"""What is always on the screen around the pages: tabs, chips, STOP, the job bar, messages, log and menus."""
