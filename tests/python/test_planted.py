# SPDX-License-Identifier: MIT
"""The faults that `make planted` plants can be planted: sources change, the list must follow."""

import tomllib
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
FAULTS = tomllib.loads((ROOT / "tests/planted.toml").read_text(encoding="utf-8"))["fault"]


@pytest.mark.parametrize("fault", FAULTS, ids=[fault["what"] for fault in FAULTS])
def test_a_fault_has_its_place(fault):
    text = (ROOT / fault["file"]).read_text(encoding="utf-8")
    assert text.count(fault["old"]) == 1
    assert fault["old"] != fault["new"]
    assert fault["test"][0] in ("unit", "verify", "emulated", "python")
    assert fault.get("slow", "why") != ""


def test_faults_are_in_all_parts():
    """Sixty and more, each its own, in every layer of the sources."""
    assert len({fault["what"] for fault in FAULTS}) == len(FAULTS) >= 60
    parts = {"/".join(Path(fault["file"]).parts[:-1][:2]) for fault in FAULTS}
    layers = "air base coupling cpu deck gpu materials output parallel solid step"
    assert parts >= {*(f"src/{layer}" for layer in layers.split()), "cuda", "post"}
