# SPDX-License-Identifier: MIT
"""What the pages name is there: files, folders, targets of make."""

import re
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
PAGES = [
    ROOT / "README.md",
    *(ROOT / name / "README.md" for name in ("src", "tests", "tests/pfstub")),
]
PAGES += sorted((ROOT / "docs").rglob("*.md"))
NAMES = [str(page.relative_to(ROOT)) for page in PAGES]
# what make, a run or a user makes; the same words begin paths in examples
MADE = ("bin/", "build/", "out/", "gpu/")
FOLDERS = {path.name for path in ROOT.iterdir() if path.is_dir()}
TARGETS = set(
    re.findall(
        r"^([a-z][\w -]*?) *:(?!=)",
        (ROOT / "Makefile").read_text() + (ROOT / "studies/Makefile").read_text(),
        re.MULTILINE,
    )
)
TARGETS = {word for line in TARGETS for word in line.split()}


def paths_in(text):
    """Words that name a file or a folder of this project, from its root."""
    for word in re.findall(r"(?<![\w./*{-])([\w-]+/[\w./*{},-]+)", text):
        path = word.rstrip(".,")
        if path.split("/")[0] in FOLDERS and not path.startswith(MADE):
            yield path


def sources_in(text):
    """Names of sources without their folder, as `edge_shares.f90` behind another of it."""
    names = re.findall(r"(?<![\w./*<{},-])([\w*{},-]+\.(?:f90|F90|CUF|pf|py|sh))\b", text)
    return set(names)


def is_there(path):
    """True for a file or folder; `*` stands for anything, `{a,b}` for each of its words."""
    braces = re.search(r"\{([^}]*)\}", path)
    if braces:
        return all(is_there(path.replace(braces[0], word)) for word in braces[1].split(","))
    return any(True for _ in ROOT.glob(path))


def is_a_source(name):
    """True for the name of a file in any folder of sources."""
    folders = ("src", "cuda", "post", "scripts", "tests", "studies")
    return any(is_there(f"{folder}/**/{name}") for folder in folders)


@pytest.mark.parametrize("page", PAGES, ids=NAMES)
def test_files_that_a_page_names_are_there(page):
    """Paths from the root of the project, and links from the page."""
    text = page.read_text()
    missing = {path for path in paths_in(text) if not is_there(path)}
    missing |= {name for name in sources_in(text) if not is_a_source(name)}
    for link in re.findall(r"\]\(([^)#:]+)(?:#[^)]*)?\)", text):
        if not (page.parent / link).exists():
            missing.add(link)
    assert not missing


@pytest.mark.parametrize("page", PAGES, ids=NAMES)
def test_targets_that_a_page_names_are_there(page):
    """`make target` in code, with or without variables."""
    text = page.read_text()
    blocks = re.findall(r"^```.*?^```", text, re.MULTILINE | re.DOTALL)
    for block in blocks:
        text = text.replace(block, "")
    lines = [re.sub("#.*", "", line) for block in blocks for line in block.splitlines()]
    code = "\n".join(lines + re.findall(r"`([^`]+)`", text))
    named = set()
    for call in re.findall(r"(?:^|[\s(])make((?: +[\w=./\"-]+)+)", code):
        named |= {word for word in call.split() if re.fullmatch(r"[a-z][a-z-]*", word)}
    assert named <= TARGETS, named - TARGETS


def names_in(text):
    """Names in code of a page that look like those of procedures and types: words and `_`."""
    text = re.sub(r"^```.*?^```", "", text, flags=re.MULTILINE | re.DOTALL)
    return set(re.findall(r"`([a-z][a-z0-9]+(?:_[a-z0-9]+)+)`", text))


@pytest.fixture(scope="module")
def known_names():
    """Words of all sources, and names of their files."""
    known = set()
    for folder in ("src", "cuda", "post", "scripts", "tests", "studies"):
        for path in (ROOT / folder).rglob("*"):
            if path.suffix.lower() in (".f90", ".cuf", ".pf", ".py", ".sh", ".c", ".ll"):
                if path.name != Path(__file__).name:
                    known |= set(re.findall(r"[a-z]\w*", path.read_text().lower()))
                known.add(path.stem)
    return known


def made_names():
    """Patterns of names that Python puts together, as f"{head}_depth"."""
    for path in (ROOT / "post").glob("*.py"):
        for text in re.findall(r'f"([^"]*)"', path.read_text()):
            for word in text.split():
                fixed = re.split(r"\{[^}]*\}", word)
                if len(fixed) > 1 and "_" in "".join(fixed) and len("".join(fixed)) > 4:
                    yield r"\w+".join(re.escape(part) for part in fixed)


MADE_NAMES = list(made_names())


def is_known(name, known):
    """True for a name in the sources, or for one that is written around one of them."""
    if any(re.fullmatch(pattern, name) for pattern in MADE_NAMES):
        return True
    item = re.fullmatch(r"each_(\w+)", name)  # the loop over an item
    family = re.fullmatch(r"[a-z]+_(kernels_t)", name)  # the launches of a family of kernels
    return bool(name in known or (item and item[1] in known) or (family and family[1] in known))


@pytest.mark.parametrize("page", PAGES, ids=NAMES)
def test_procedures_that_a_page_names_are_there(page, known_names):
    """Names of procedures, keys and columns, as `sort_bin`."""
    missing = {name for name in names_in(page.read_text()) if not is_known(name, known_names)}
    assert not missing


def test_what_is_not_there_is_seen(tmp_path, known_names):
    """The tests above can fail."""
    assert names_in("the procedure `no_such_procedure` of") == {"no_such_procedure"}
    assert not is_known("no_such_procedure", known_names)
    assert is_known("crater_depth", known_names)
    assert is_known("sort_bin", known_names) and is_known("each_press_links", known_names)
    assert list(paths_in("see `src/no_such_file.f90`.")) == ["src/no_such_file.f90"]
    assert not is_there("src/no_such_file.f90")
    assert not is_there("src/{air,no_such_folder}")
    assert is_there("src/cpu/*.f90")
    assert sources_in("(`src/air/no.f90`, `test_no.py`)") == {"test_no.py"}
    assert not is_a_source("test_no.py")
    assert is_a_source("edge_shares.f90")
    assert is_a_source("test_{docs,loads}.py")
    assert not is_a_source("test_{docs,no}.py")
    assert "lint" in TARGETS
    assert "docs" not in TARGETS
