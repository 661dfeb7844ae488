# SPDX-License-Identifier: MIT
"""Energies, reactions and impulses of bodies on the GPU: those of the CPU, after a restart too."""

from test_gpu import _deck, equal_backends  # noqa: F401
from test_run import history

# a plate that bends, a strip that is pulled, a block that strikes and rubs, concrete that gives way
BOOKS = """&run t_end=1e-4, max_steps=70, dimension=2 /
&material id='e', model='linear_elastic', density=1500, youngs_modulus=3e9, poisson_ratio=0.3 /
&material id='al', preset='al2024' /
&material id='hjc', preset='hjc_48' /
&body id='plate', box=0,0.012, 0,0.003, 0,1, spacing=0.001, material='e', fix='x-',
      formulation='bending' /
&body id='strip', box=0.02,0.028, 0,0.004, 0,1, spacing=0.001, material='e', fix='x-',
      formulation='uncorrected', artificial_stress='gray', velocity=0,0,0 /
&body id='block', box=0.005,0.011, 0.0031,0.0081, 0,1, spacing=0.001, material='al',
      velocity=-90,-150,0 /
&body id='wall', box=0.0,0.012, -0.0061,-0.0001, 0,1, spacing=0.001, material='hjc', fix='y-',
      velocity=0,60,0 /
&load body='strip', faces='x+', pressure=-8e7 /
&load body='block', faces='y+', time=0,4e-6, pressure=5e7,0 /
&interaction law='contact', friction=0.3, damping=0.5 /
&output history_every=0, checkpoint_every=1e-7 /
"""
# what a body may keep or lose: all of it, in this scene
KEPT = ("hourglass", "artificial", "viscous", "hourglass_heat", "plastic", "damage", "contact",
        "contact_heat", "friction", "load_work", "solid_kinetic", "solid_internal")  # fmt: skip
# a chip that turns flies out, in tension
GONE = """&body id='chip', box=0.03,0.034, 0,0.004, 0,1, spacing=0.001, material='al',
      velocity=2500,0,0, spin=0,0,1e5 /
&body id='splinter', box=0.03,0.034, 0.006,0.01, 0,1, spacing=0.001, material='e',
      velocity=2500,0,0, spin=0,0,1e5 /
&solid region=-1,0.035, -1,1, -1,1, leave='remove' /
"""


def test_diagnostics_are_those_of_the_cpu_after_a_restart_too(deck):
    equal_backends(deck, BOOKS, 40, ("energy", "bodies"), 1e-9)
    columns = history(deck / "gpu" / "energy.csv")
    for name in KEPT:  # it has something to say before the restart and after it
        column = columns[f"{name}[J]"]
        assert abs(column[40]) > 1e-6 and abs(column[-1]) > 1e-6, name
        assert column[40] != column[-1], name


def test_diagnostics_of_what_is_taken_out_are_those_of_the_cpu(deck):
    equal_backends(deck, BOOKS + GONE, 40, ("energy", "bodies"), 1e-9)
    columns = history(deck / "gpu" / "energy.csv")
    assert 0 < columns["removed[kg]"][41] < columns["removed[kg]"][-1]
