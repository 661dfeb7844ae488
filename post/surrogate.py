# SPDX-License-Identifier: MIT
"""A formula in place of runs, with its own error; and which parameter decides.

Two are tried on the logarithms: a polynomial of degree 2, and a Gaussian process with a length for
each parameter. The one whose cross-validated error is smaller is kept. It is written as numbers
(`surrogate.json`), which `predict` evaluates with numpy alone.
"""

from __future__ import annotations

import warnings
from dataclasses import dataclass

import numpy as np

FOLDS = 8
WORST = 0.1  # rms error from which no surrogate is offered
NOISE = 1e-10, 1e-1


@dataclass(frozen=True)
class Errors:
    """Of a cross-validated prediction, relative."""

    rms: float
    largest: float
    q2: float  # share of the variance of the logarithm that is told


@dataclass
class Surrogate:
    """A fitted formula of positive parameters (k) for a positive result."""

    kind: str  # 'polynomial' or 'gaussian_process'
    names: list[str]
    errors: dict[str, Errors]  # of both kinds
    data: dict  # numbers that `predict` needs; logarithms of inputs are `log`
    sign: float = 1.0  # of the result: the formula has its size

    @property
    def error(self) -> Errors:
        """Of the kind that was kept."""
        return self.errors[self.kind]


def predict(data: dict, points) -> np.ndarray:
    """Results (n) at points (n, k), from the numbers of `surrogate.json` and numpy alone."""
    x = np.atleast_2d(np.asarray(points, float))
    x = np.where(data["log"], np.log(np.maximum(x, 1e-300)), x)
    z = (x - data["mean"]) / data["scale"]
    if data["kind"] == "polynomial":
        powers = np.asarray(data["powers"])
        terms = np.prod(z[:, None, :] ** powers[None], axis=2)
        return np.exp(terms @ np.asarray(data["coefficients"]))
    gap = (z[:, None, :] - np.asarray(data["points"])[None]) / np.asarray(data["lengths"])
    kernel = data["amplitude"] * np.exp(-0.5 * (gap**2).sum(axis=2))
    return np.exp(kernel @ np.asarray(data["weights"]) * data["spread"] + data["level"])


def fit_surrogate(names: list[str], points, values) -> Surrogate:
    """The better of both through runs: points (n, k), positive values (n).

    ValueError for fewer than 8 runs or values that are not positive.
    """
    from sklearn.model_selection import KFold, cross_val_predict  # noqa: PLC0415 (slow to load)
    from threadpoolctl import threadpool_limits  # noqa: PLC0415

    x, y = np.atleast_2d(np.asarray(points, float)), np.asarray(values, float)
    if len(y) < FOLDS or not (y > 0).all():
        raise ValueError(f"a surrogate needs {FOLDS} runs or more, and positive results")
    logs = (x > 0).all(axis=0)
    u, v = np.where(logs, np.log(np.maximum(x, 1e-300)), x), np.log(y)
    folds = KFold(FOLDS, shuffle=True, random_state=0)
    errors, models = {}, _models(x.shape[1])
    terms = (x.shape[1] + 1) * (x.shape[1] + 2) // 2
    for kind, model in list(models.items()):
        if kind == "polynomial" and len(y) < 1.2 * terms + 1:
            models.pop(kind)  # more coefficients than a fold has points
            continue
        with warnings.catch_warnings(), threadpool_limits(1):  # small matrices: threads only wait
            warnings.simplefilter("ignore")  # lengths at their bounds: the error tells
            guess = cross_val_predict(model, u, v, cv=folds)
            model.fit(u, v)
        part = np.expm1(guess - v)
        spread = float(np.var(v)) or 1.0
        rms, top = float(np.sqrt(np.mean(part**2))), float(np.abs(part).max())
        errors[kind] = Errors(rms, top, 1 - float(np.var(guess - v)) / spread)
    best = min(errors, key=lambda kind: errors[kind].rms)
    data = _numbers(best, models[best]) | {"kind": best, "log": logs.tolist(), "names": names}
    return Surrogate(best, names, errors, data)


def _models(count: int) -> dict:
    from sklearn.gaussian_process import GaussianProcessRegressor  # noqa: PLC0415
    from sklearn.gaussian_process.kernels import RBF, ConstantKernel, WhiteKernel  # noqa: PLC0415
    from sklearn.linear_model import LinearRegression  # noqa: PLC0415
    from sklearn.pipeline import make_pipeline  # noqa: PLC0415
    from sklearn.preprocessing import PolynomialFeatures, StandardScaler  # noqa: PLC0415

    kernel = ConstantKernel() * RBF(np.ones(count), (0.05, 1e3)) + WhiteKernel(1e-4, NOISE)
    process = GaussianProcessRegressor(kernel, normalize_y=True, random_state=0)
    formula = PolynomialFeatures(2), LinearRegression(fit_intercept=False)
    return {
        "polynomial": make_pipeline(StandardScaler(), *formula),
        "gaussian_process": make_pipeline(StandardScaler(), process),
    }


def _numbers(kind: str, model) -> dict:
    """What `predict` needs of a fitted model."""
    scaler, last = model[0], model[-1]
    data = {"mean": scaler.mean_.tolist(), "scale": scaler.scale_.tolist()}
    if kind == "polynomial":
        powers = model[1].powers_.tolist()
        return data | {"powers": powers, "coefficients": last.coef_.tolist()}
    parts = last.kernel_.k1
    return data | {
        "points": last.X_train_.tolist(),
        "weights": last.alpha_.ravel().tolist(),
        "lengths": np.broadcast_to(parts.k2.length_scale, last.X_train_.shape[1]).tolist(),
        "amplitude": float(parts.k1.constant_value),
        "spread": float(last._y_train_std),
        "level": float(last._y_train_mean),
    }


@dataclass(frozen=True)
class Share:
    """What one parameter does to a result: shares of its variance."""

    name: str
    first: float  # alone
    total: float  # with all in which it takes part
    low: float  # 90 % limits of the total
    high: float


def sensitivity(surrogate: Surrogate, parameters: list, runs: int = 2**11) -> list[Share]:
    """Sobol's indices of a surrogate over the distributions of its parameters."""
    from scipy.stats import sobol_indices  # noqa: PLC0415 (slow to load)

    def response(shares):
        rows = [one.quantile(np.clip(s, 1e-9, 1 - 1e-9))
                for one, s in zip(parameters, shares, strict=True)]  # fmt: skip
        return np.log(predict(surrogate.data, np.transpose(rows)))

    from scipy.stats import uniform  # noqa: PLC0415

    found = sobol_indices(func=response, n=runs, dists=[uniform(0, 1)] * len(parameters), rng=1)
    spread = found.bootstrap(confidence_level=0.9, n_resamples=99)
    total = spread.total_order.confidence_interval
    return [
        Share(one.name, float(found.first_order[k]), float(found.total_order[k]),
              float(total.low[k]), float(total.high[k]))
        for k, one in enumerate(parameters)
    ]  # fmt: skip
