import time

import pytest

from core.threads import in_threads


def test_results_come_in_the_order_of_the_items():
    def square_late(x):
        time.sleep(0.02 * (3 - x % 3))
        return x * x

    assert in_threads(square_late, range(7)) == [0, 1, 4, 9, 16, 25, 36]


def test_the_first_failure_is_raised():
    with pytest.raises(ZeroDivisionError):
        in_threads(lambda x: 1 / x, [2, 0, 1])
