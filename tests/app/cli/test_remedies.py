"""The terminal words every remedy."""

from app.cli.remedies import REMEDIES, worded
from core.errors import Remedy, StageError


def test_every_remedy_has_its_words():
    assert set(REMEDIES) == set(Remedy)
    assert all(words.endswith(".") for words in REMEDIES.values())


def test_the_remedy_follows_what_happened():
    assert worded(StageError("It broke.")) == "It broke."
    assert worded(StageError("It broke.", Remedy.FEWER_WORKERS)).startswith(
        "It broke. Run the same command with"
    )
