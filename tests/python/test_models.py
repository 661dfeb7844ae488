# SPDX-License-Identifier: MIT
"""A material model is one file: what is written from it names it on both backends."""

import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).parents[2]
MODEL = """module brz_{name}
    use brz_twig_slots, only: h_last
    integer, parameter :: {name} = {code} !! code of the model
    integer, parameter :: n_modes = 2
contains
    subroutine describe_{name}(model)
        model%n_hist = {slots}
    end subroutine
    pure subroutine update_{name}(material, dt, l, point, status)
    end subroutine
end module
"""


def written(folder, *models):
    """The result of the writer for models (name, code, slots)."""
    slots = folder / "twig_slots.f90"
    slots.write_text("integer, parameter, public :: h_first = 4, h_last = 6\n")
    paths = [slots]
    for name, code, slots in models:
        paths.append(folder / f"{name}.f90")
        paths[-1].write_text(MODEL.format(name=name, code=code, slots=slots))
    command = [sys.executable, ROOT / "scripts/models.py", folder, *paths]
    return subprocess.run(command, capture_output=True, text=True, check=False)


def test_a_file_is_a_model_on_both_backends(tmp_path):
    done = written(tmp_path, ("twig", 2, "h_last + n_modes"), ("leaf", 1, "1"))
    assert done.returncode == 0, done.stderr
    listed = (tmp_path / "model_list.f90").read_text()
    assert "call describe_leaf(models(1))\n        call describe_twig(models(2))" in listed
    assert "case (twig)\n            call update_twig(material, dt, l, point, status)" in listed
    kernels = (tmp_path / "model_kernels.CUF").read_text()
    # 6 slots of the file that it uses and 2 of its own
    assert "call advance_point(twig, 8, n, dt, body, material, grad, state, &" in kernels
    assert "call advance_point(leaf, 1, n, dt, body, material, grad, state, &" in kernels


def test_a_metal_is_a_flow_stress(tmp_path):
    """A cold one, and one that feels heat and says what it takes of it."""
    head = "integer, parameter :: {0} = {1} !! code of the model\nmodel%n_hist = {2}\n"
    flow = "pure subroutine flow_{0}({1})\n"
    lead = head.format("lead", 1, 1) + flow.format("lead", "par, strain, rate, y")
    zinc = head.format("zinc", 2, 3) + flow.format("zinc", "par, strain, rate, heat, y")
    zinc += "pure function heat_zinc(par, hot) result(soft)\n"
    for name, text in (("lead", lead), ("zinc", zinc)):
        (tmp_path / f"{name}.f90").write_text(text)
    command = [sys.executable, ROOT / "scripts/models.py", tmp_path]
    subprocess.run([*command, tmp_path / "lead.f90", tmp_path / "zinc.f90"], check=True)
    listed = (tmp_path / "model_list.f90").read_text()
    assert "case (lead)\n            call update_metal(lead, material, dt, l," in listed
    flows = (tmp_path / "flow_list.f90").read_text()
    assert "call flow_lead(par, strain, rate, y)" in flows
    assert "heat = heat_zinc(par, hot)" in flows
    assert "yes = model == zinc\n" in flows
    assert "advance_point(zinc, 3, n" in (tmp_path / "model_kernels.CUF").read_text()


def test_a_code_stands_for_one_model(tmp_path):
    done = written(tmp_path, ("twig", 2, "1"), ("leaf", 2, "1"))
    assert done.returncode != 0
    assert "the same code; 1 is free" in done.stderr


def test_slots_must_be_known(tmp_path):
    done = written(tmp_path, ("twig", 2, "h_other"))
    assert done.returncode != 0
    assert "h_other of model%n_hist is no constant that is known" in done.stderr
