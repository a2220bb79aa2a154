"""STOP in a process of its own: no dialog, menu, page or busy main loop can hold it up."""
