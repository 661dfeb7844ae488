# SPDX-License-Identifier: MIT
"""In what the decks of several runs differ."""

from __future__ import annotations

from typing import Any

from post.deck import Deck, as_list
from post.tables import Table

LONGEST = 60  # letters of a value that are shown
WORDS = {("run", "title")}  # keys that say nothing about the physics


def deck_values(deck: Deck) -> dict[str, Any]:
    """Values of a complete deck by name: `air.cells`, `body(plate).spacing`.

    Groups of which there may be several go by their id, or by their number where they have none.
    """
    found = {}
    for name in deck.names:
        for number, group in enumerate(deck.groups(name), 1):
            alone = len(deck.groups(name)) == 1 and "id" not in group
            label = name if alone else f"{name}({group.get('id') or number})"
            for key, value in group.items():
                if key != "id" and (name, key) not in WORDS:
                    found[f"{label}.{key}"] = value
    return found


def deck_table(decks: list[Deck], names: list[str]) -> Table:
    """The keys in which decks differ, a column for each deck; a dash where a deck has no such key.

    Keys of a group that some deck lacks altogether are told in one row.
    """
    values = [deck_values(deck) for deck in decks]
    keys = list(dict.fromkeys(key for one in values for key in one))
    owners = [{key.rsplit(".", 1)[0] for key in one} for one in values]
    rows, told = [], set()
    for key in keys:
        owner = key.rsplit(".", 1)[0]
        if not all(owner in have for have in owners):
            if owner not in told:
                told.add(owner)
                rows.append((f"&{owner}", *("yes" if owner in have else "–" for have in owners)))
        elif any(_plain(one.get(key)) != _plain(values[0].get(key)) for one in values):
            rows.append((key, *(_plain(one.get(key)) for one in values)))
    return Table("Differences of the decks", ("key", *names), rows)


def _plain(value: Any) -> str:
    """A value as a short text."""
    if value is None:
        return "–"
    text = ", ".join(f"{v:g}" if isinstance(v, float) else str(v) for v in as_list(value))
    return text if len(text) <= LONGEST else f"{text[: LONGEST - 4]} ..."
