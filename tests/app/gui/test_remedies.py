"""The window words every remedy, and names no command."""

import pytest

from app.gui.remedies import remedy_words, worded
from core.errors import Remedy, StageError


@pytest.mark.parametrize("remedy", list(Remedy))
def test_a_remedy_is_a_sentence_without_a_command(remedy):
    words = remedy_words(remedy)
    assert words.endswith(".")
    assert "--" not in words and "poursight" not in words and "command" not in words


def test_the_remedy_follows_what_happened():
    assert worded(StageError("It broke.")) == "It broke."
    assert worded(StageError("It broke.", Remedy.NEW_SESSION)) == "It broke. Start a new session."
