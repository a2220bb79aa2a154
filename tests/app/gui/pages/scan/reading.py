"""What a user reads and clicks on the page."""

from __future__ import annotations

from PySide6.QtWidgets import QLabel, QListView, QPushButton


def text(page, name):
    return page.findChild(QLabel, name).text()


def button(page, name):
    return page.findChild(QPushButton, name)


def primary(page):
    return button(page, "primary")


def headline(page):
    return text(page, "headline")


def details(page):
    return text(page, "details")


def states(page):
    return [item.state for item in page.left.grid.items]


def pick_thumbnail(page, index):
    entries = page.left.grid.findChild(QListView)
    entries.setCurrentIndex(entries.model().index(index, 0))
