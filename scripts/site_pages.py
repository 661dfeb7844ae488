# SPDX-License-Identifier: MIT
"""What the site has besides docs: README.md is its front page, CHANGELOG.md its last.

A hook of MkDocs (mkdocs.yml). Links of both are those of the root of the project; in the site
docs is the root.
"""

import re
from pathlib import Path

from mkdocs.structure.files import File

PAGES = {"index.md": "README.md", "changes.md": "CHANGELOG.md"}


def in_site(text: str) -> str:
    """A page of the root with the links that it has in the site."""
    for page, source in PAGES.items():
        text = text.replace(f"]({source})", f"]({page})")
    return re.sub(r"\]\(docs/", "](", text)


def on_files(files, config):
    """Add the pages; MkDocs calls it once the files of docs are known."""
    root = Path(config.config_file_path).parent
    for page, source in PAGES.items():
        content = in_site((root / source).read_text(encoding="utf-8"))
        files.append(File.generated(config, page, content=content))
    return files
