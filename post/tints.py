# SPDX-License-Identifier: MIT
"""Which body is which in a picture of damage: a pale colour for each material, or each body.

Damage up to `FADED` turns the colour of a body into that of the common scale.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from matplotlib.colors import to_rgb
from matplotlib.patches import Patch

from post.deck import Body, Deck
from post.style import DAMAGE

TINTS = ("#d5dbe1", "#e9cf95", "#b5d3a6", "#e6b3a6", "#c5b8e0", "#a9d6df", "#e0c3d4", "#cfd08f")
UNKNOWN = "#ff00ff"  # damage that is not finite
FADED = 0.25  # damage from which the scale alone is shown


@dataclass(frozen=True)
class Tints:
    """Colour of each body, and what the colours mean."""

    of_body: dict[int, int]  # number of the body: place in TINTS
    labels: list[str]  # one for each colour, in the order of TINTS

    def paint(self, damage: np.ndarray, body: np.ndarray) -> np.ndarray:
        """Colours (n, 3) of particles of some damage (n) in some bodies (n)."""
        place = np.array([self.of_body.get(int(b), 0) for b in np.unique(body)], int)
        pale = np.array([to_rgb(tint) for tint in TINTS])[place]
        pale = pale[np.searchsorted(np.unique(body), body)]
        known = np.isfinite(damage)
        damage = np.clip(np.where(known, damage, 0.0), 0, 1)
        rest = np.clip(1 - damage / FADED, 0, 1)[:, None]
        mixed = rest * pale + (1 - rest) * DAMAGE(damage)[:, :3]
        return np.where(known[:, None], mixed, to_rgb(UNKNOWN))

    @property
    def height(self) -> float:
        """Room that the legend takes below the panels [inch]."""
        return 0.2 * len(self.labels) + 0.3

    def legend(self, figure) -> None:
        """What the colours of undamaged bodies mean, below the panels of a figure."""
        patches = [
            Patch(facecolor=TINTS[i], edgecolor="#8a929b", lw=0.6, label=label)
            for i, label in enumerate(self.labels)
        ]
        if patches:
            figure.legend(
                handles=patches,
                title="where there is no damage",
                loc="outside lower left",
                fontsize=8,
                title_fontsize=8,
                alignment="left",
                handlelength=1.4,
            )


def tints_of(deck: Deck) -> Tints:
    """One colour for each material that bodies are made of; for each body if there is but one."""
    bodies = deck.bodies()
    materials = list(dict.fromkeys(body.material for body in bodies))
    if len(materials) > 1:
        groups = [[b for b in bodies if b.material == name] for name in materials]
    else:
        groups = [[body] for body in bodies]
    if len(groups) > len(TINTS):
        groups = [*groups[: len(TINTS) - 1], [b for g in groups[len(TINTS) - 1 :] for b in g]]
    number = {body.number: place for place, group in enumerate(groups) for body in group}
    return Tints(number, [_label(deck, group) for group in groups])


def _label(deck: Deck, group: list[Body]) -> str:
    """'steel (johnson_cook): bars_x, bars_y at 6 mm; ball at 2 mm'."""
    materials = list(dict.fromkeys(body.material for body in group))
    name = ", ".join(f"{m} ({deck.model_of(m)})" if deck.model_of(m) else m for m in materials)
    spacings = dict.fromkeys(f"{1e3 * body.spacing:.3g}" for body in group)
    parts = [
        _names([b.id for b in group if f"{1e3 * b.spacing:.3g}" == size]) + f" at {size} mm"
        for size in spacings
    ]
    return f"{name}: {'; '.join(parts)}"


def _names(names: list[str], most: int = 6) -> str:
    """Names one after the other, the middle left out where there are many."""
    if len(names) <= most:
        return ", ".join(names)
    return f"{', '.join(names[: most - 1])} ... {names[-1]} ({len(names)} bodies)"
