# SPDX-License-Identifier: MIT
"""Searches, P-I hyperbolas, fragility curves, surrogates and sensitivities with known answers."""

import json
import math
import sys
import warnings
from pathlib import Path

import numpy as np
import pytest

HERE = Path(__file__).parent
sys.path[:0] = [str(HERE.parents[1]), str(HERE)]

from post.designs import Parameter  # noqa: E402
from post.fragility import by_likelihood, by_line, by_share  # noqa: E402
from post.limits import (  # noqa: E402
    bracket,
    bracketing,
    fit_hyperbola,
    guess_between,
    meet,
    meeting,
    together,
    waves,
)
from post.surrogate import fit_surrogate, predict, sensitivity  # noqa: E402


@pytest.mark.parametrize("power", [0.6, 1.1, 2.0, -1.5])
@pytest.mark.parametrize("guess", [0.2, 3.0, 40.0])
def test_a_power_law_is_met_in_few_runs(power, guess):
    found = meet(lambda x: 5 * (x / 3.0) ** power, 5.0, guess, 0.005, power > 0)
    assert found.value == pytest.approx(3.0, rel=0.005) and len(found.runs) <= 6
    assert not found.message


def test_a_kink_is_met_by_its_bracket():
    """A response that hardly moves and then jumps up: the secant is led back into the bracket."""
    found = meet(lambda x: 1 + 0.01 * x + (50 * (x - 7) if x > 7 else 0), 20.0, 1.0, 0.01)
    assert found.value == pytest.approx(7 + (20 - 1.07) / 50.01, rel=0.003)
    assert found.low < found.value < found.high or abs(found.runs[-1][1] / 20 - 1) < 0.01


def test_a_response_that_is_none_ends_the_search():
    found = meet(lambda x: math.nan, 1.0, 2.0)
    assert math.isnan(found.value) and found.message == "no response at 2"


@pytest.mark.parametrize(("low", "high"), [(120, 400), (300, 400), (40, 60)])
@pytest.mark.parametrize("rising", [True, False])
def test_both_ends_of_a_bracket_are_run(low, high, rising):
    """The limit is 234: a bracket that lies elsewhere is moved; both ends were run."""
    asked = []

    def event(x):
        asked.append(x)
        return (x > 234) == rising

    found = bracket(event, low, high, 0.02, rising)
    assert found.low < 234 < found.high and found.high / found.low <= 1.02
    assert {found.low, found.high} <= set(asked) and len(asked) <= 14
    assert bracket(lambda x: None, low, high).message.startswith("neither yes nor no")


def asks(search, response):
    """What a search finds, and how often it asks."""
    rounds = []

    def ask(pairs):
        rounds.append(len(pairs))
        return [response(x) for _, x in pairs]

    return together({0: search}, ask)[0], rounds


@pytest.mark.parametrize("power", [0.6, 1.1, 2.0, -1.5])
@pytest.mark.parametrize("guess", [0.2, 3.0, 40.0])
def test_several_points_at_once_meet_a_target_sooner(power, guess):
    def bent(x):
        return 5 * (x / 3.0) ** power * (1 + 0.1 * math.log(x / 3.0) ** 2)

    one, rounds = asks(meeting(5.0, guess, 0.005, power > 0), bent)
    some, fewer = asks(meeting(5.0, guess, 0.005, power > 0, at_once=3), bent)
    assert one.value == pytest.approx(3.0, rel=0.01) and some.value == pytest.approx(3.0, rel=0.01)
    assert len(fewer) <= len(rounds) and max(fewer) == 3
    assert len(some.runs) == sum(fewer)


@pytest.mark.parametrize(("low", "high"), [(120, 400), (300, 400), (40, 60)])
@pytest.mark.parametrize("at_once", [1, 3, 7])
def test_several_points_split_a_bracket(low, high, at_once):
    """P points leave one of P + 1 parts; none lies closer than the tolerance asks for."""
    one, rounds = asks(bracketing(low, high, 0.02), lambda x: x > 234)
    some, fewer = asks(bracketing(low, high, 0.02, at_once=at_once), lambda x: x > 234)
    assert some.low < 234 < some.high and some.high / some.low <= 1.02
    assert some.value == pytest.approx(one.value, rel=0.02)
    assert len(fewer) <= len(rounds) and fewer[0] == at_once + 2
    assert at_once < 7 or len(fewer) <= 4


def test_an_answer_that_is_none_matters_at_the_limit_alone():
    def event(x):
        return None if 200 < x < 240 else x > 220

    found, _ = asks(bracketing(150, 400, 0.02, at_once=3), event)
    assert found.message.startswith("neither yes nor no at 2") and math.isnan(found.value)
    found, _ = asks(bracketing(150, 400, 0.02, at_once=3), lambda x: None if x > 390 else x > 170)
    assert found.low < 170 < found.high and not found.message


def test_searches_go_on_in_step():
    """Two limits: what both ask for at the same time is asked for together."""
    rounds = []

    def ask(pairs):
        rounds.append([k for k, _ in pairs])
        return [5 * (x / 3.0) ** (2 - k) for k, x in pairs]

    found = together({k: meeting(5.0, 1.0 + 2 * k, 0.005) for k in (0, 1)}, ask)
    assert [found[k].value for k in (0, 1)] == pytest.approx([3.0, 3.0], rel=0.005)
    assert rounds[0] == [0, 1] and rounds[-1] == [0] and len(rounds) == len(found[0].runs)


def test_guesses_and_waves():
    known = [(1.0, 10.0), (100.0, 1.0)]
    assert guess_between(10.0, known, 5.0) == pytest.approx(math.sqrt(10))
    assert guess_between(1e4, known, 5.0) == pytest.approx(0.1)
    assert guess_between(3.0, [], 5.0) == 5.0
    assert waves(7) == [[0, 6], [3], [1, 2, 4, 5]] and waves(1) == [[0]]
    assert waves(7, packed=True) == [[0, 6, 3], [1, 2, 4, 5]]


def test_the_hyperbola_is_found_from_points_on_it():
    p0, i0, c = 0.66e6, 1540.0, 0.23
    impulse = i0 * np.array([1.02, 1.03, 1.06, 1.15, 1.4, 2.2, 4.5])
    pressure = p0 * (1 + c / (impulse / i0 - 1))
    found = fit_hyperbola(pressure, impulse)
    assert (found.p0, found.i0, found.c) == pytest.approx((p0, i0, c), rel=1e-3)
    assert found.rms < 1e-5 and found.pressure(impulse) == pytest.approx(pressure, rel=1e-3)
    shifted = fit_hyperbola(pressure * 1.02, impulse * 1.02)  # along rays that is 2 %
    assert (shifted.p0, shifted.i0) == pytest.approx((1.02 * p0, 1.02 * i0), rel=1e-3)
    with pytest.raises(ValueError, match="three points"):
        fit_hyperbola([1.0, 2.0], [1.0, 2.0])


def test_fragility_of_known_median_and_scatter():
    """600 cases of theta 1600, beta 0.2: likelihood within three standard errors; its limits."""
    rng = np.random.default_rng(3)
    intensity = np.exp(rng.uniform(np.log(900), np.log(2600), 600))
    passed = np.log(intensity / 1600) / 0.2 > rng.standard_normal(600)
    found = by_likelihood(intensity, passed)
    assert found.theta == pytest.approx(1600, rel=0.035) and found.beta == pytest.approx(
        0.2, abs=0.05
    )
    assert found.low < 1600 < found.high and found.high / found.low < 1.08
    assert found.chance(found.theta) == pytest.approx(0.5)
    size = 35e-3 * (intensity / 1600) ** 1.4 * np.exp(0.28 * rng.standard_normal(600))
    line = by_line(intensity, size, 35e-3)
    assert line.theta == pytest.approx(1600, rel=0.03) and line.beta == pytest.approx(0.2, abs=0.03)
    grid = np.geomspace(700, 3500, 400)
    share = by_share(grid, found.chance(grid))
    assert (share.theta, share.beta) == pytest.approx((found.theta, found.beta), rel=0.01)


def test_without_overlap_there_is_no_beta():
    found = by_likelihood([900, 1200, 1564, 1592, 2000], [0, 0, 0, 1, 1])
    assert math.isnan(found.beta) and found.theta == pytest.approx(math.sqrt(1564 * 1592))
    assert "no overlap" in found.message
    assert "all of 2 runs" in by_likelihood([1.0, 2.0], [1, 1]).message


def sample(count, seed=1):
    return np.exp(np.random.default_rng(seed).uniform(0, 1, (count, 3)))


def test_a_surrogate_tells_its_own_error():
    """Exact where the formula has the shape; its error is told where it has not."""
    x = sample(24)
    exact = fit_surrogate(["a", "b", "c"], x, x[:, 0] ** 2 * x[:, 1] / np.sqrt(x[:, 2]))
    assert exact.kind == "polynomial" and exact.error.rms < 1e-9
    noise = np.exp(0.03 * np.random.default_rng(2).standard_normal(24))
    rough = fit_surrogate(["a", "b", "c"], x, x[:, 0] ** 2 * noise)
    assert 0.015 < rough.error.rms < 0.06
    with pytest.raises(ValueError, match="8 runs or more"):
        fit_surrogate(["a"], [[1.0]] * 3, [1.0] * 3)


def test_numbers_of_a_surrogate_are_those_of_its_model():
    """`predict`, from JSON and numpy alone, against scikit-learn."""
    from sklearn.gaussian_process import GaussianProcessRegressor  # noqa: F401, PLC0415

    from post.surrogate import _models, _numbers  # noqa: PLC0415

    x, new = sample(30), sample(20, 5)
    y = np.log(x[:, 0]) + np.sin(2 * x[:, 1]) + 3
    for kind, model in _models(3).items():
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            model.fit(np.log(x), y)
        data = _numbers(kind, model) | {"kind": kind, "log": [True] * 3}
        data = json.loads(json.dumps(data))
        assert predict(data, new) == pytest.approx(np.exp(model.predict(np.log(new))), rel=1e-9)


def test_sensitivities_of_a_product():
    """ln y = 2 ln a + ln b over equal ranges: four fifths and one fifth, and nothing together."""
    x = sample(24)
    one = fit_surrogate(["a", "b", "c"], x, x[:, 0] ** 2 * x[:, 1])
    parameters = [Parameter(n, law="loguniform", numbers=(1.0, math.e)) for n in "abc"]
    shares = sensitivity(one, parameters)
    assert [s.first for s in shares] == pytest.approx([0.8, 0.2, 0.0], abs=0.02)
    assert [s.total for s in shares] == pytest.approx([0.8, 0.2, 0.0], abs=0.02)
    assert shares[0].low < 0.8 < shares[0].high
