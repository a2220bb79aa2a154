"""The pipeline's stages in the user's words."""

from __future__ import annotations

from PySide6.QtCore import QCoreApplication


def stage_words(stage: str) -> str:
    """Return what is being done, for the job bar; the stage's own name if it is a new one."""
    translate = QCoreApplication.translate
    words = {
        "views": translate("Stage", "Looking at the board"),
        "choosing views": translate("Stage", "Choosing the scan's views"),
        "import": translate("Stage", "Reading the images"),
        "scan": translate("Stage", "Taking views"),
        "reconstruction": translate("Stage", "Reconstructing the surface"),
        "quality": translate("Stage", "Checking the scan"),
        "colors": translate("Stage", "Colouring the model"),
        "first look": translate("Stage", "Finding the object's box"),
        "looking again": translate("Stage", "Choosing further views"),
        "collision": translate("Stage", "Making the collision model"),
        "containability": translate("Stage", "Dropping candies"),
        "capacity": translate("Stage", "Filling it with candies"),
        "retention": translate("Stage", "Tilting it until candies fall out"),
        "hollows": translate("Stage", "Finding its hollows"),
        "cup": translate("Stage", "Simulating the cup"),
        "pouring": translate("Stage", "Simulating pours"),
        "risk": translate("Stage", "Trying the best pours with disturbances"),
        "motion": translate("Stage", "Checking the arm's motions"),
        "evidence": translate("Stage", "Rendering pictures"),
        "pour": translate("Stage", "Pouring"),
        "difference": translate("Stage", "Comparing the surfaces"),
        "export": translate("Stage", "Writing the file"),
        "unpack": translate("Stage", "Unpacking the session"),
        "outcome": translate("Stage", "Counting candies"),
    }
    return words.get(stage, stage.capitalize())


def step_name(stage: str) -> str:
    """Return a step's name among the others of a job: one word."""
    translate = QCoreApplication.translate
    names = {
        "import": translate("Step", "Images"),
        "reconstruction": translate("Step", "Surface"),
        "quality": translate("Step", "Check"),
        "colors": translate("Step", "Colours"),
        "collision": translate("Step", "Body"),
        "containability": translate("Step", "Drop"),
        "capacity": translate("Step", "Fill"),
        "retention": translate("Step", "Tilt"),
        "pouring": translate("Step", "Pours"),
        "risk": translate("Step", "Risk"),
        "motion": translate("Step", "Arm"),
        "evidence": translate("Step", "Pictures"),
    }
    return names.get(stage, stage.capitalize())
