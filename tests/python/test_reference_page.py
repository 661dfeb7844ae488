# SPDX-License-Identifier: MIT
"""The page of all keys, which `--describe --markdown` writes."""

import os
import re
import subprocess
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
BRISANCE = Path(os.environ.get("BRISANCE", ROOT / "bin/brisance"))


def describe(*words):
    done = subprocess.run(
        [BRISANCE, "--describe", *words], capture_output=True, text=True, check=True
    )
    return done.stdout


def keys_of_models(text, heading, key):
    """By model, the keys in the part of a text behind its heading."""
    parts = re.split(heading, text)
    return {
        name: set(re.findall(key, part))
        for name, part in zip(parts[1::2], parts[2::2], strict=True)
    }


def test_every_key_of_a_model_is_in_its_table_or_named_behind_it():
    """Rows that an earlier model has, too, are named, and that model's table has them."""
    page, material = describe("--markdown"), describe("material", "--all")
    page = page[page.index("## &material") : page.index("## &body")]
    told = keys_of_models(
        material, r"with model='(\w+)'", r"(?m)^  (\w+) +(?:real|integer|text|logical|\d)"
    )
    shown = keys_of_models(page, r"### model='(\w+)'", r"(?m)^\| `(\w+)` \|")
    named = {}
    for model, text in re.findall(r"### model='(\w+)'(.*?)(?=\n##|\Z)", page, re.DOTALL):
        for like, keys in re.findall(r"as in `(\w+)`:([^.]*)\.", text):
            named[model] = set(re.findall(r"`(\w+)`", keys))
            assert named[model] <= shown[like]
    assert told and told == {model: shown[model] | named.get(model, set()) for model in shown}
    assert {"voce", "cowper_symonds"} <= set(named)
