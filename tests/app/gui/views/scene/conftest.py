"""3D views of one program share their OpenGL contexts; Qt wants to know before there is an application."""

from __future__ import annotations

from PySide6.QtCore import QCoreApplication, Qt

if QCoreApplication.instance() is None:
    QCoreApplication.setAttribute(Qt.ApplicationAttribute.AA_ShareOpenGLContexts)
