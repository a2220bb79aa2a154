"""What all real cameras share about time."""

from typing import Final

FRAMES_IN_FLIGHT: Final = 3
"""Frames that may have been exposed before a call and yet arrive after it.

One is being exposed and up to two are being read out and sent. Counting needs no clock that the camera and
the computer share.
"""

SETTLING_FRAMES: Final = 30
"""Frames after connecting in which exposure and white balance still find their values."""

WAIT_S: Final = 2.0
"""How long a new image may take; longer than `FRAMES_IN_FLIGHT` at the slowest rate these cameras know."""
