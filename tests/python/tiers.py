# SPDX-License-Identifier: MIT
"""Parameters of tests that `make test` leaves to `make test-all`."""

import pytest


def slow(*values):
    """Values of a parametrised test that is slow with them."""
    return pytest.param(*values, marks=pytest.mark.slow)
