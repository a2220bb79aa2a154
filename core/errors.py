"""What can go wrong, said so that the reader knows what to do.

Every message is one sentence: what happened, where, and what to do about it. The command line prints it
and exits with 1; the desktop shows it. A traceback therefore always means a fault in the program.
"""


class PoursightError(Exception):
    """Anything the program can explain to its user in a sentence."""


class InputError(PoursightError):
    """A file, a folder or a value given by the user cannot be used as it is."""


class SessionError(PoursightError):
    """A session cannot be read, written or locked."""


class StageError(PoursightError):
    """A stage got valid input but could not reach a result with it."""


class WorkerError(PoursightError):
    """A worker process died or could not be started."""


class MotionError(PoursightError):
    """The arm cannot go where it should, or not without touching something."""


class Cancelled(PoursightError):
    """The user asked to stop; what was finished before is kept."""
