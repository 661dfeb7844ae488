# SPDX-License-Identifier: MIT
"""How much of each body is broken, and how: loose, failed, cracked in tension, crushed."""

from __future__ import annotations

import numpy as np

from post.errors import PostError
from post.fragments import find_fragments
from post.impact import FAILED
from post.perforation import BROKEN, MODES
from post.reader import Frame, Run

# kinds of damage: fields of the dumps, and the value from which a particle counts
KINDS = {
    "failed": (("damage",), FAILED),
    "tensile": (("damage_tension",), BROKEN),
    "crushed": (("damage_hjc",), BROKEN),
    "fibre": (MODES["fibres broken"], BROKEN),
    "matrix": (MODES["matrix broken"], BROKEN),
    "delaminated": (MODES["delaminated"], BROKEN),
}
WORDS = {
    "loose": "no longer hangs together with the largest piece",
    "failed": f"damage of {FAILED:g} and more: carries nothing in tension",
    "tensile": f"cracked in tension: tensile damage above {BROKEN:g}",
    "crushed": f"crushed: damage in compression above {BROKEN:g}",
    "fibre": f"broken fibres: damage above {BROKEN:g}",
    "matrix": f"cracked or crushed between the fibres: damage above {BROKEN:g}",
    "delaminated": f"delaminated: damage above {BROKEN:g}",
}


def damaged_volumes(run: Run, frame: Frame, body: str) -> dict[str, float]:
    """Volume of a body that is damaged, by kind, of the whole scene [m3].

    Volumes are those of the unloaded particles. Kinds that the body does not have are left out,
    and all where nothing is damaged. A particle may count under several kinds.
    """
    which = next(one for one in run.deck.bodies() if one.id == body)
    fields = sorted({name for names, _ in KINDS.values() for name in names})
    solid = frame.solid("body", "mass", *fields, lacking=True)
    own = solid.field["body"] == which.number
    mass = solid.field.get("mass", np.ones(len(own)))[own].astype(float)
    whole = mass / mass.max(initial=1e-300)  # a particle cut by a plane of symmetry is less
    cell = float(np.prod(which.step[: int(run.deck.get("run", "dimension", 3))]))
    found = {}
    loose = _loose(run, frame, body)
    if loose > 0:
        found["loose"] = loose * cell * run.deck.images
    for kind, (names, limit) in KINDS.items():
        there = [solid.field[name][own] for name in names if name in solid.field]
        if there and (count := float(whole[np.max(there, axis=0) >= limit].sum())):
            found[kind] = count * cell * run.deck.images
    return found


def _loose(run: Run, frame: Frame, body: str) -> int:
    """Particles of the modelled part that hang on the largest piece no longer; of a body that was
    several parts at the start on the largest of their own part.
    """
    try:
        pieces = find_fragments(run, frame, body)
    except PostError:
        return 0  # on no lattice
    return sum(piece.particles for piece in pieces if not piece.main)
