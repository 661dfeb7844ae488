# SPDX-License-Identifier: MIT
"""A search for a term of the field finds the file that docs/manual/glossary.md names."""

import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
ROW = re.compile(r"^\| (?P<term>[^|]+) \| (?P<here>[^|]+) \| `(?P<file>[^`]+)` \|$", re.M)
ROWS = [
    pytest.param(term, row["file"], id=term)
    for row in ROW.finditer((ROOT / "docs/manual/glossary.md").read_text())
    for term in row["term"].split(", ")
]


def words(text):
    """The words of a text, without what is a matter of spelling."""
    return re.sub(r"[^a-z0-9]+", " ", text.lower())


def test_the_glossary_has_the_terms_of_an_expert():
    assert len(ROWS) > 50


@pytest.mark.parametrize(("term", "file"), ROWS)
def test_a_term_of_the_field_is_in_the_file_that_is_named(term, file):
    assert words(term).strip() in words((ROOT / "src" / file).read_text())
