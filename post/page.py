# SPDX-License-Identifier: MIT
"""The frame of the HTML report: quiet on the screen, clean on paper."""

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
