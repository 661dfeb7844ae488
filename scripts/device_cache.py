# SPDX-License-Identifier: MIT
"""GPU code is built once for each content of what it is made from: results are kept by that.

An edit of a source that no kernel uses, or one that is taken back, costs a copy of a file.
"""

import hashlib
import shutil
from pathlib import Path

from cuda_fortran import in_order
from depend import scan

KEPT = 8  # results of other contents that stay
SCRIPTS = Path(__file__).parent


def files_of(sources, wanted):
    """The `wanted` ones of some sources and all that they use, in a fixed order."""
    needs, owner = {}, {}
    for path in sources:
        makes, needs[path] = scan(path)
        owner.update({module: path for module in makes})
    return [path for group in in_order(wanted, needs, owner) for path in group]


def key_of(files, words):
    """A name for the contents of files and for some words, say options and versions."""
    total = hashlib.sha1(repr(words).encode())
    for path in files:
        total.update(f"\n{path}\n".encode() + Path(path).read_bytes())
    return total.hexdigest()[:20]


def take(folder, name, out):
    """Copy a kept result to a file; whether there is one."""
    kept = folder / name
    if not kept.is_file():
        return False
    kept.touch()
    out.parent.mkdir(parents=True, exist_ok=True)
    shutil.copy(kept, out)
    return True


def keep(folder, name, made):
    """Keep a result under a name; the oldest ones go."""
    folder.mkdir(parents=True, exist_ok=True)
    shutil.copy(made, folder / f".{name}")
    (folder / f".{name}").rename(folder / name)
    every = sorted(folder.glob(f"*{Path(name).suffix}"), key=lambda path: path.stat().st_mtime)
    for old in every[:-KEPT]:
        old.unlink()
