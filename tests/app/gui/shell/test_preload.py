"""No thread makes Qt's classes while the window works."""

from __future__ import annotations

import subprocess
import sys

_PROGRAM = """
import sys
from PySide6 import QtCore, QtWidgets
from app.gui.shell.preload import Imports, Preload

def missing():
    modules = [module for name, module in sys.modules.items() if name.startswith("PySide6.Qt")]
    return {f"{one.__name__}.{name}" for one in modules for name in dir(one) if name not in vars(one)}

class Watched(Imports):
    def run(self):
        found.append(missing())
        super().run()
        found.append(missing())

found = []
application = QtCore.QCoreApplication([])
assert missing(), "PySide makes all its classes at once: there is nothing to do any more"
preload = Preload(application)
preload._imports = Watched(application)
preload._imports.finished.connect(application.quit)
preload.start()
assert not found, "it must not hold the window up"
application.exec()
print([sorted(one) for one in found])
"""


def test_all_of_qts_classes_are_there_before_modules_are_imported_in_a_thread():
    """PySide makes a class when it is first asked for; what pyqtgraph imports of Qt is made before, too."""
    done = subprocess.run([sys.executable, "-c", _PROGRAM], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[[], []]"


def test_a_window_may_close_before_all_is_there():
    program = (
        "from PySide6.QtCore import QCoreApplication; from app.gui.shell.preload import Preload; "
        "application = QCoreApplication([]); preload = Preload(application); preload.start(); "
        "preload.close(); application.processEvents(); print(preload._imports.isRunning())"
    )
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "False"
