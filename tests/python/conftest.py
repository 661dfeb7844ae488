# SPDX-License-Identifier: MIT
"""The tiers of tests, and what each test has computed.

`@pytest.mark.slow` leaves a test to `make test-all`; `@pytest.mark.long("reason")` lets one of
`make test` take more core-seconds than scripts/run_tests.py allows. JUnit reports have the
core-seconds of each test, of its fixtures and of the programs that it has run, as property `core`.
"""

import os

import pytest


def pytest_configure(config):
    config.addinivalue_line("markers", "slow: left to make test-all")
    config.addinivalue_line("markers", "long(reason): why a test of make test may take long")


def core_seconds():
    """What this process and the programs that it has waited for have computed [s]."""
    return sum(os.times()[:4])


@pytest.hookimpl(tryfirst=True)
def pytest_runtest_setup(item):
    item.core_seconds = core_seconds()


@pytest.hookimpl(tryfirst=True)
def pytest_runtest_makereport(item, call):
    """The report of the last phase takes the properties into the XML."""
    if call.when == "teardown" and hasattr(item, "core_seconds"):
        spent = core_seconds() - item.core_seconds
        item.user_properties.append(("core", f"{spent:.3f}"))
        if mark := item.get_closest_marker("long"):
            item.user_properties.append(("long", mark.args[0]))
