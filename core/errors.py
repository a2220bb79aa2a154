"""What can go wrong, said so that the reader knows what to do.

Every message is one sentence: what happened and where. What to do about it is part of the sentence if it is
the same for everybody ("take a larger cup"), and a `Remedy` if terminal and window word it differently. The
command line prints both and exits with 1; the desktop shows them. A traceback therefore always means a fault
in the program.
"""

from __future__ import annotations

from enum import Enum


class Remedy(Enum):
    """What the user can do; the front ends say how."""

    RUN_AGAIN = "run again"
    """Do the same once more; what was finished is kept."""
    CONTINUE = "continue"
    """Go on where it was interrupted."""
    FEWER_WORKERS = "fewer workers"
    """Do the same with fewer worker processes, for memory is short."""
    RUN_STAGES = "run the stages"
    """Run the stages of the session: a damaged one is made anew."""
    JUDGE_MOTIONS = "judge the motions"
    """Ask again which of the pours the arm can make."""
    IMPORT_SCAN = "import a scan"
    """Scan an object, or import a scan."""
    NEW_SESSION = "new session"
    """Use another session."""
    SCAN_THE_MESH = "scan the mesh"
    """Scan the mesh in the simulated cell."""
    CHOOSE_OBJECT = "choose an object"
    """Choose the object that stands in the simulated cell."""
    NO_OBJECT = "no object"
    """Put the object on the platform, and choose none."""
    OTHER_CELL = "another cell"
    """Use another cell."""
    START_CLUSTER = "start a cluster"
    """Start the workers that the evaluation shall use."""
    POUR_ANYWAY = "pour anyway"
    """Say explicitly that it shall be poured although it is not advised."""
    EMPTY_HAND = "empty the hand"
    """Bring home what a pour left in the hand, or take it and open the gripper."""
    RESTART_SCAN = "restart the scan"
    """Discard the views that were taken, and scan anew."""
    RESTART_CALIBRATION = "restart the calibration"
    """Leave the looks of an interrupted calibration aside, and calibrate anew."""


class PoursightError(Exception):
    """Anything the program can explain to its user in a sentence.

    Attributes:
        remedy: what to do; none if the sentence says it.
    """

    def __init__(self, message: str = "", remedy: Remedy | None = None) -> None:
        super().__init__(message)
        self.remedy = remedy

    def __reduce__(self) -> tuple[type[PoursightError], tuple[str, Remedy | None]]:
        """Errors cross process borders whole."""
        return type(self), (str(self), self.remedy)


class InputError(PoursightError):
    """A file, a folder or a value given by the user cannot be used as it is."""


class SessionError(PoursightError):
    """A session cannot be read, written or locked."""


class StageError(PoursightError):
    """A stage got valid input but could not reach a result with it."""


class NotAdvised(StageError):
    """Nothing is wrong, but a pour is too likely to spill; it has to be asked for explicitly."""


class WorkerError(PoursightError):
    """A worker process died or could not be started."""


class MotionError(PoursightError):
    """The arm cannot go where it should, or not without touching something."""


class Cancelled(PoursightError):
    """The user asked to stop; what was finished before is kept."""
