# SPDX-License-Identifier: MIT
"""The frame of HTML pages that need no other file: quiet on the screen, clean on paper."""

from __future__ import annotations

import base64
from html import escape

from post.style import Picture
from post.tables import Table

PAGE = """<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>{title}</title>
<style>
body {{ max-width: 960px; margin: 2em auto; padding: 0 1em; color: #20242a; background: #fff;
  font: 16px/1.45 system-ui, "Segoe UI", "DejaVu Sans", sans-serif; }}
h1 {{ font-size: 1.5em; border-bottom: 2px solid #1f5a93; padding-bottom: .3em; }}
h2 {{ font-size: 1.15em; margin: 1.8em 0 .5em; color: #1f5a93; break-after: avoid; }}
table {{ border-collapse: collapse; font-size: .88em; width: 100%; break-inside: avoid;
  font-variant-numeric: tabular-nums; }}
th, td {{ text-align: left; padding: .3em .7em .3em 0; border-bottom: 1px solid #dfe3e7;
  vertical-align: top; }}
th {{ color: #4a525b; font-weight: 600; }}
table.facts {{ width: auto; }}
figure {{ margin: 0; break-inside: avoid; }}
img {{ display: block; width: 100%; max-width: 900px; height: auto; }}
figcaption, .note {{ font-size: .88em; color: #4a525b; margin: .5em 0 0; max-width: 900px; }}
.problems {{ border-left: 4px solid #b3312c; background: #faf1f0; padding: .5em 1em;
  margin: 1em 0; }}
.problems ul {{ margin: .3em 0 0; padding-left: 1.2em; }}
pre {{ background: #f6f7f8; padding: 1em; font-size: .8em; line-height: 1.35;
  white-space: pre-wrap; overflow-wrap: anywhere; }}
@media print {{ body {{ margin: 0; font-size: 11pt; }} pre {{ font-size: 8pt; }} }}
</style>
</head>
<body>
<h1>{title}</h1>
{body}
</body>
</html>
"""


def html_problems(problems: list[str]) -> str:
    """A box with what is not as it should be; an empty text without problems."""
    items = "".join(f"<li>{escape(text)}</li>" for text in problems)
    return f'<div class="problems"><b>Please note</b><ul>{items}</ul></div>' if problems else ""


def html_table(table: Table) -> str:
    heads = "".join(f"<th>{escape(head)}</th>" for head in table.heads)
    rows = "".join(
        "<tr>" + "".join(f"<td>{escape(cell)}</td>" for cell in row) + "</tr>" for row in table.rows
    )
    note = f'<p class="note">{escape(table.note)}</p>' if table.note else ""
    return f"<h2>{escape(table.title)}</h2><table><tr>{heads}</tr>{rows}</table>{note}"


def html_picture(picture: Picture) -> str:
    data = base64.b64encode(picture.path.read_bytes()).decode()
    return (
        f"<h2>{escape(picture.title)}</h2><figure>"
        f'<img src="data:image/png;base64,{data}" alt="{escape(picture.title)}">'
        f"<figcaption>{escape(picture.caption)}</figcaption></figure>"
    )
