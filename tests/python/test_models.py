# SPDX-License-Identifier: MIT
"""A material model is one file: what is written from it names it on both backends."""

import re
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).parents[2]
MODEL = """module brz_{name}
    integer, parameter :: {name} = {code}{slots} !! code of the model
contains
    subroutine describe_{name}(model)
        model%n_hist = 7
    end subroutine
    pure subroutine update_{name}(material, dt, l, point, status)
    end subroutine
end module
"""


def written(folder, *models):
    """The result of the writer for models (name, code, slots)."""
    paths = []
    for name, code, slots in models:
        paths.append(folder / f"{name}.f90")
        paths[-1].write_text(MODEL.format(name=name, code=code, slots=slots))
    command = [sys.executable, ROOT / "scripts/models.py", folder, *paths]
    return subprocess.run(command, capture_output=True, text=True, check=False)


def test_a_file_is_a_model_on_both_backends(tmp_path):
    done = written(tmp_path, ("twig", 2, ", twig_history = 8"), ("leaf", 1, ", leaf_history = 1"))
    assert done.returncode == 0, done.stderr
    listed = (tmp_path / "model_list.f90").read_text()
    text = "\n".join(x for x in listed.splitlines() if not x.startswith("# "))
    assert "call describe_leaf(models(1))\n        call describe_twig(models(2))" in text
    assert "case (twig)\n            call update_twig(material, dt, l, point, status)" in text
    # the compiler speaks of the model where a line was written for it, else of what was written
    twig = tmp_path / "twig.f90"
    assert f'# 2 "{twig}"\n            call update_twig(' in listed
    place = listed.splitlines().index("    use brz_kinds, only: rk") + 1
    assert f'# {place} "{tmp_path / "model_list.f90"}"\n    use brz_kinds, only: rk' in listed
    kernels = (tmp_path / "model_kernels.CUF").read_text()
    assert "call advance_point(twig, 8, n, dt, tiles, bodies, grad, state, &" in kernels
    assert "call advance_point(leaf, 1, n, dt, tiles, bodies, grad, state, &" in kernels


def test_a_metal_is_a_flow_stress(tmp_path):
    """A cold one, and one that feels heat and says what it takes of it."""
    head = "integer, parameter :: {0} = {1}, {0}_history = {2} !! code of the model\n"
    flow = "pure subroutine flow_{0}({1})\n"
    lead = head.format("lead", 1, 1) + flow.format("lead", "par, strain, rate, y")
    zinc = head.format("zinc", 2, 3) + flow.format("zinc", "par, strain, rate, heat, y")
    zinc += "pure function heat_zinc(par, hot) result(soft)\n"
    for name, text in (("lead", lead), ("zinc", zinc)):
        (tmp_path / f"{name}.f90").write_text(text)
    command = [sys.executable, ROOT / "scripts/models.py", tmp_path]
    subprocess.run([*command, tmp_path / "lead.f90", tmp_path / "zinc.f90"], check=True)
    listed, flows = (
        re.sub("# .*\n", "", (tmp_path / f"{x}_list.f90").read_text()) for x in ("model", "flow")
    )
    assert "case (lead)\n            call update_metal(lead, material, dt, l," in listed
    assert "call flow_lead(par, strain, rate, y)" in flows
    assert "heat = heat_zinc(par, hot)" in flows
    assert "yes = model == zinc\n" in flows
    assert "advance_point(zinc, 3, n" in (tmp_path / "model_kernels.CUF").read_text()


def test_a_code_stands_for_one_model(tmp_path):
    done = written(tmp_path, ("twig", 2, ", twig_history = 1"), ("leaf", 2, ", leaf_history = 1"))
    assert done.returncode != 0
    assert "the same code; 1 is free" in done.stderr


def test_a_history_has_a_length(tmp_path):
    done = written(tmp_path, ("twig", 2, ""))
    assert done.returncode != 0
    assert "a model with a history says how long: twig_history = ..." in done.stderr
