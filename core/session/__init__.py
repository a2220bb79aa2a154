"""A session: a folder of open formats, one sub-folder a stage, each written whole or not at all.

session.json              format, name and creation time
reconstruction/           a stage's own files ...
reconstruction/record.json    ... and what they were made from, so that stale or fresh can be computed
"""

from core.session.explaining import explained
from core.session.record import StageRecord
from core.session.session import Session

__all__ = ["Session", "StageRecord", "explained"]
