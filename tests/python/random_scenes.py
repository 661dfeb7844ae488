# SPDX-License-Identifier: MIT
"""Random decks: small scenes that draw on all that a deck can ask for.

The scenes are meant to be odd, not sensible: a restart must give the same bytes in each of them.
"""

import itertools
import math
import random

ROOM = [18e-3, 12e-3, 12e-3]  # half sides of the air; bodies lie in x > 0 [m]
PLASTIC = ["al2024", "steel_4340", "rebar", "ofhc_copper", "al6061"]
PLIES = ["cfrp_ud", "cfrp_woven"]
CONCRETE = ["hjc_48", "hjc_44", "concrete_48"]
UNBREAKABLE = ["soft"]
FORMS = ["auto", "bending", "corrected_hourglass", "corrected", "uncorrected", "paper"]
FORMS += ["total_lagrangian", "rigid"]


def numbers(values):
    return ", ".join(f"{value:.8g}" for value in values)


class Scene:
    """One deck being drawn."""

    def __init__(self, seed):
        self.rng = random.Random(seed)
        self.seed = seed
        self.groups = []
        self.dimension = self.rng.choice([1, 2, 2, 2, 3, 3])
        self.axes = "xyz"[: self.dimension]
        self.air = self.chance(0.5)
        self.early = self.air and self.chance(0.3)
        self.planes = [a for a in self.axes if self.chance(0.3)]
        if self.early:
            self.planes = [a for a in self.planes if a != "x"]
        self.spacing = {1: 2e-4, 2: 6e-4, 3: 1e-3}[self.dimension]
        self.bodies = []

    def chance(self, p):
        return self.rng.random() < p

    def add(self, group, **keys):
        text = ", ".join(f"{key}={value}" for key, value in keys.items() if value is not None)
        self.groups.append(f"&{group} {text} /")

    def vector(self, scale):
        """A vector in the directions that are modelled."""
        return [self.rng.uniform(-scale, scale) if a in self.axes else 0.0 for a in "xyz"]

    def draw(self):
        symmetry = ", ".join(f"'{a}'" for a in self.planes) or None
        self.add("run", title=f"'scene {self.seed}'", t_end="1e-3", dimension=self.dimension,
                 symmetry=symmetry)  # fmt: skip
        if self.air:
            self.draw_air()
        self.draw_materials()
        for i in range(self.rng.choice([0, 1, 1, 2, 3] if self.air else [1, 2, 2, 3])):
            self.draw_body(f"b{i}")
        self.draw_laws()
        self.draw_solid()
        self.draw_gauges()
        self.draw_output()
        return "\n".join(self.groups) + "\n"

    def draw_air(self):
        rng = self.rng
        flux = rng.choice(["hllc", "hllc", "steger_warming"])
        scheme = rng.choice(["muscl", "muscl", "first_order", "weno3", "weno5z"])
        integrator = "ssprk3" if scheme == "weno5z" else rng.choice(["ssprk2", "ssprk3"])
        box, cells = [], []
        for i, a in enumerate("xyz"):
            low = 0 if a in self.planes else -ROOM[i]
            box += [low, ROOM[i]]
            n = {1: 60, 2: 20, 3: 9}[self.dimension] * (ROOM[i] - low) / ROOM[0]
            cells.append(rng.randint(int(0.9 * n), int(1.2 * n)) if a in self.axes else 1)
        self.add("air", box=numbers(box), cells=numbers(cells), flux=f"'{flux}'",
                 reconstruction=f"'{scheme}'", integrator=f"'{integrator}'",
                 activity=rng.choice([".true.", ".false."]),
                 ramp_steps=rng.choice([0, 5, 20]), cfl=rng.choice([0.3, 0.5, 0.8]),
                 bc=rng.choice(["'outflow'", "'wall'", None]))  # fmt: skip
        if self.early:
            self.draw_charge()
        else:
            for i in range(rng.randint(0, 2)):
                side = rng.uniform(1e-3, 6e-3)
                gas = [box[0], box[0] + side, -1, 1, -1, 1]
                self.add("gas", id=f"'g{i}'", box=numbers(gas), density=rng.uniform(1, 10),
                         pressure=rng.uniform(2e5, 2e7),
                         velocity=numbers(self.motion(300.0)))  # fmt: skip
        if self.chance(0.3):
            self.add("coupling",
                     scheme=rng.choice(["'cut_cells'", "'cut_cells'", "'paper'"]))  # fmt: skip

    def draw_charge(self):
        """A charge that starts in one dimension, in front of the bodies."""
        radius = self.rng.uniform(0.8e-3, 1e-3)
        depth = math.prod(2 * r for a, r in zip("xyz", ROOM, strict=True) if a not in self.axes)
        volume = {1: 2 * radius, 2: math.pi * radius**2, 3: 4 / 3 * math.pi * radius**3}
        self.add("charge", id="'tnt'", mass=f"{1630 * depth * volume[self.dimension]:.6g}",
                 start="'1d'", eos=self.rng.choice(["'ideal'", "'jwl'"]), radial_cells=40,
                 at=numbers([-ROOM[0] / 2, 0, 0]),
                 shape="'cylinder'" if self.dimension == 2 else None)  # fmt: skip

    def draw_materials(self):
        self.add("material", id="'soft'", model="'linear_elastic'", density=1000,
                 youngs_modulus=5e8, poisson_ratio=0.3)  # fmt: skip
        self.add("material", id="'metal'", preset=f"'{self.rng.choice(PLASTIC)}'")
        self.add("material", id="'ply'", preset=f"'{self.rng.choice(PLIES)}'")
        self.add("material", id="'concrete'", preset=f"'{self.rng.choice(CONCRETE)}'")

    def draw_body(self, name):
        """Bodies lie side by side along x, a random gap apart."""
        rng = self.rng
        d = self.spacing
        low = self.bodies[-1]["end"] if self.bodies else rng.choice([0, 1e-3])
        low += d * rng.choice([0, 0, 0, 0.2, 1])
        material = rng.choice(["soft", "metal", "ply", "concrete"])
        form = rng.choice(FORMS)
        if material not in UNBREAKABLE and form == "total_lagrangian":
            form = "bending"
        keys = dict(id=f"'{name}'", spacing=d, material=f"'{material}'", formulation=f"'{form}'")
        body = dict(name=name, end=low + rng.randint(3, 5) * d, form=form)
        self.draw_shape(low, material, body, keys)
        self.draw_motion(low, body, keys)
        keys.update(self.numerics(form))
        body["bonds"] = form != "total_lagrangian" and "variable_h" not in keys
        self.bodies.append(body)
        self.add("body", **keys)

    def draw_shape(self, low, material, body, keys):
        rng = self.rng
        d = self.spacing
        shape = rng.choice(["box", "box", "sphere"]) if self.dimension > 1 else "box"
        if material == "ply":
            shape = "box"
            keys["plies"] = rng.choice(["'0'", "'0/90'", "'[0/45]s'"])
            keys["ply_axis"] = f"'{rng.choice(self.axes)}'"
        if shape == "sphere":
            body["end"] = low + 5 * d
        body["half"] = half = (body["end"] - low) / 2
        if shape == "sphere":
            keys.update(shape="'sphere'", radius=f"{half:.8g}", centre=numbers([low + half, 0, 0]))
            return
        box = [low, body["end"]]
        for a in "yz":
            wide = rng.randint(3, 7) * d
            start = 0.0 if a in self.planes else rng.choice([0, rng.uniform(0, 1e-3)]) - wide / 2
            box += [start, start + wide] if a in self.axes else [-1, 1]
        body["half"] = max((abs(v) for v in box[2:] if abs(v) < 1), default=half)
        keys["box"] = numbers(box)

    def draw_motion(self, low, body, keys):
        """Held, driven or free, and then mostly toward the neighbour."""
        rng = self.rng
        rigid = body["form"] == "rigid"
        speed = rng.choice([0, 50, 300, 300, 1500])
        driven = self.chance(0.25)
        if driven and not rigid and "box" in keys:
            keys.update(fix=rng.choice(["'x-'", "'x+'"]), fix_layers=1)
        if driven and (rigid or "fix" in keys) and self.chance(0.7):
            v = numbers(self.motion(60.0))
            keys.update(motion_time="0, 2e-6, 1", motion_velocity=f"0, 0, 0, {v}, {v}")
            return
        velocity = self.motion(speed)
        if self.chance(0.7) and (low > self.spacing or "x" not in self.planes):
            velocity = [-speed if self.bodies else speed, 0.2 * velocity[1], 0.2 * velocity[2]]
        keys["velocity"] = numbers(velocity)
        if self.chance(0.2) and self.dimension > 1:
            keys["spin"] = numbers(self.turning())

    def motion(self, speed):
        """A velocity that keeps planes of symmetry where it must."""
        return [0.0 if a in self.planes else v
                for a, v in zip("xyz", self.vector(speed), strict=True)]  # fmt: skip

    def turning(self):
        if self.dimension == 2:
            return [0, 0, 0 if self.planes else self.rng.uniform(-1e4, 1e4)]
        if len(self.planes) > 1:
            return [0, 0, 0]
        if self.planes:
            return [self.rng.uniform(-1e4, 1e4) if a in self.planes else 0 for a in "xyz"]
        return [self.rng.uniform(-1e4, 1e4) for _ in range(3)]

    def numerics(self, form):
        rng = self.rng
        keys = {}
        if form not in ("rigid", "total_lagrangian", "bending", "auto") and self.chance(0.3):
            keys["variable_h"] = ".true."
        if form in ("uncorrected", "paper", "corrected") and self.chance(0.3):
            keys["artificial_stress"] = rng.choice(["'monaghan'", "'gray'"])
        if self.chance(0.3):
            keys["limiter"] = "'balsara'"
        if self.chance(0.3):
            keys["cfl"] = rng.choice([0.2, 0.6])
        return keys

    def draw_laws(self):
        rng = self.rng
        if self.chance(0.5):
            self.add("interaction", law="'contact'", friction=rng.choice([0, 0.3, 0.3]),
                     shared_pressure=rng.choice([".true.", ".false."]),
                     stiffness=rng.choice([0.5, 1]))  # fmt: skip
        for a, b in itertools.pairwise(self.bodies):
            law = rng.choice(["contact", "bonded", "bonded", "none", None, None])
            if law == "bonded" and not (a["bonds"] and b["bonds"]):
                law = "contact"
            keys = {}
            if law == "bonded" and self.chance(0.7):
                keys = dict(tensile_strength=rng.choice([1e5, 1e7]), shear_strength=1e7,
                            bond_law=rng.choice(["'quadratic'", "'cut_off'"]))  # fmt: skip
            if law:
                self.add(
                    "interaction", bodies=f"'{a['name']}', '{b['name']}'", law=f"'{law}'", **keys
                )

    def draw_solid(self):
        keys = {}
        if self.chance(0.5):
            keys["skin"] = self.rng.choice([0.1, 0.3, 0.6])
        if self.chance(0.7):
            near = self.rng.choice([0.1, 0.3, 0.7]) * self.spacing  # around the bodies
            high = self.bodies[-1]["end"] + near if self.bodies else 1
            half = max((b["half"] for b in self.bodies), default=1) + near
            keys["region"] = numbers([-near, high, -half, half, -half, half])
            keys["leave"] = self.rng.choice(["'remove'", "'remove'", "'remove'", "'report'"])
        elif self.air and self.chance(0.5):
            keys["leave"] = "'remove'"
        if keys and self.bodies:
            self.add("solid", **keys)

    def draw_gauges(self):
        if self.air and self.chance(0.7):
            at = [0.7 * r if a in self.axes else 0 for a, r in zip("xyz", ROOM, strict=True)]
            self.add("gauge", id="'p'", at=numbers(at), quantity="'pressure'")
        if self.bodies and self.chance(0.7):
            end = self.bodies[-1]["end"]
            self.add("gauge", id="'u'", at=numbers([end - self.spacing, 0, 0]),
                     quantity="'velocity_x'", body=f"'{self.bodies[-1]['name']}'")  # fmt: skip

    def draw_output(self):
        every = self.rng.choice([0, 0, 1e-7])
        self.add("output", history_every=every, dump_every=self.rng.choice([1e-6, 5e-6, None]),
                 checkpoint_every=self.rng.choice([2e-7, 1e-6, None]))  # fmt: skip


def draw(seed):
    """The deck that belongs to a seed."""
    return Scene(seed).draw()
