import pytest

from core.errors import InputError
from core.imagination.amount.result import HALF, MOST_ASKED, SAFE, AmountRequest, parse_amount


@pytest.mark.parametrize(
    ("text", "request_"),
    [
        ("safe", SAFE),
        (" Half\n", HALF),
        ("45", AmountRequest("number", 45)),
        ("1", AmountRequest("number", 1)),
        ("up to 60", AmountRequest("up_to", 60)),
        (" Up to  7 ", AmountRequest("up_to", 7)),
        (str(MOST_ASKED), AmountRequest("number", MOST_ASKED)),
    ],
)
def test_what_is_said_is_understood_and_said_again(text, request_):
    assert parse_amount(text) == request_
    assert parse_amount(str(request_)) == request_


@pytest.mark.parametrize(
    "text",
    [
        "a dozen",
        "",
        "12.5",
        "1e2",
        "1_0",
        "²",
        "٣",
        "9" * 5000,
        "--1",
        "safe half",
        "up to",
        "up to safe",
        "upto 5",
    ],
)
def test_what_is_no_amount_is_told_with_what_to_say(text):
    with pytest.raises(InputError) as caught:
        parse_amount(text)
    message = str(caught.value)
    assert f'"{text}"' in message
    assert '"safe"' in message
    assert '"half"' in message
    assert "whole number" in message


@pytest.mark.parametrize("text", ["0", "-3", "-0"])
def test_less_than_one_candy_is_told(text):
    with pytest.raises(
        InputError, match=f"^{int(text)} candies cannot be poured; ask for .* from 1 to 99999"
    ):
        parse_amount(text)
