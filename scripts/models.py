#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Write the registry of the material models, and their kernels; docs/manual/extending.md says how.

usage: models.py OUTDIR FILE...    (model_list.f90, flow_list.f90, model_kernels.CUF)

A model is a file NAME.f90 with the line

    integer, parameter :: NAME = CODE, NAME_history = SLOTS !! code of the model

(SLOTS: most history variables; without a history CODE alone), `describe_NAME`, and `update_NAME`. A
metal of von Mises has `flow_NAME` in place of `update_NAME`, its flow stress, and
`heat_NAME` where that takes something else than the temperature: src/materials/metal.f90. Lines
that are written for a model have a mark of that line of its file.
"""

import re
import sys
from pathlib import Path
from typing import NamedTuple

from loop_heads import at_line, line_at

HEAD = re.compile(
    r"^ *integer, parameter :: (\w+) = (\d+)(?:, \1_history = (\d+))? !! code of the model", re.M
)
RESUME = "# here"  # the lines that follow are of the file that is written


class Model(NamedTuple):
    code: int
    name: str
    update: str  # arguments, of a metal as well
    slots: int  # most history variables
    flow: str  # arguments of the flow stress of a metal, "" of others
    heat: bool  # has a heat_NAME
    path: Path
    line: int  # of its code

    def warm(self):
        """Whether it is a metal that feels heat."""
        return bool(self.flow) and "heat" in re.findall(r"\w+", self.flow)

    def lines(self, *lines):
        """Lines that are written for it."""
        return [*at_line(lines, self.line, self.path), RESUME]


def model_of(path):
    """The model of a file, or None."""
    text = path.read_text(encoding="utf-8")
    if not (found := HEAD.search(text)):
        return None
    name = found[1]
    heads = dict(re.findall(rf"^ *pure \w+ (\w+)_{name}\(([^)]*)\)", text, re.M))
    update, flow = heads.get("update"), heads.get("flow", "")
    if update is None and not flow:
        sys.exit(f"{path}: no 'pure subroutine update_{name}' nor flow_{name}")
    if "model%n_hist" in text and not found[3]:
        sys.exit(f"{path}: a model with a history says how long: {name}_history = ...")
    if flow:
        update = f"{name}, material, dt, l, point, status"
    line = line_at(text, found.start())
    return Model(int(found[2]), name, update, int(found[3] or 0), flow, "heat" in heads, path, line)


def listed(models):
    """The module that names, describes and dispatches them."""
    lines = []
    for m in models:
        update = "" if m.flow else f", update_{m.name}"
        lines += m.lines(f"    use brz_{m.name}, only: {m.name}, describe_{m.name}{update}")
    lines += ["    use brz_metal, only: update_metal"] if any(m.flow for m in models) else []
    lines += [
        "    use brz_kinds, only: rk",
        "    use brz_material, only: material_t, material_unknown, point_t",
        "    use brz_model, only: model_t",
        "    implicit none",
        "    private",
        "    public :: list_models, apply_model, find_kernel_of",
        "",
        "contains",
        "",
        "    !> All models.",
        "    subroutine list_models(models)",
        "        type(model_t), allocatable, intent(out) :: models(:)",
        "",
        f"        allocate (models({len(models)}))",
    ]
    for k, m in enumerate(models, 1):
        lines += m.lines(f"        call describe_{m.name}(models({k}))")
    lines += [
        "    end subroutine list_models",
        "",
        "    !> The physics of one step of one material point.",
        "    !@cuf attributes(host,device) &",
        "    pure subroutine apply_model(model, material, dt, crack, l, point, status)",
        "        integer, intent(in) :: model !! code",
        "        type(material_t), intent(in) :: material",
        "        real(rk), intent(in) :: dt, crack, l(3, 3)",
        "        type(point_t), intent(inout) :: point",
        "        integer, intent(out) :: status",
        "",
        "        select case (model)",
    ]
    for m in models:
        call = f"            call update_{'metal' if m.flow else m.name}({m.update})"
        lines += m.lines(f"        case ({m.name})", call)
    lines += [
        "        case default; status = material_unknown",
        "        end select",
        "    end subroutine apply_model",
        "",
        "    !> Kernel of a model, '' without one, and how many history variables it has room for.",
        "    pure subroutine find_kernel_of(model, name, slots)",
        "        integer, intent(in) :: model !! code",
        "        character(:), allocatable, intent(out) :: name",
        "        integer, intent(out) :: slots",
        "",
        "        name = ''",
        "        slots = 0",
        "        select case (model)",
    ]
    for m in models:
        given = [f"            name = 'update_by_{m.name}'", f"            slots = {m.slots}"]
        lines += m.lines(f"        case ({m.name})", *given)
    lines += ["        end select", "    end subroutine find_kernel_of"]
    return lines


def flows(metals):
    """The module that dispatches the flow stresses of the metals, for brz_metal."""
    lines = []
    for m in metals:
        heat = f", heat_{m.name}" if m.heat else ""
        lines += m.lines(f"    use brz_{m.name}, only: {m.name}, flow_{m.name}{heat}")
    lines += [
        "    use brz_kinds, only: rk",
        "    use brz_material, only: n_par",
        "    implicit none",
        "    private",
        "    public :: flow_of, heat_of, feels_heat",
        "",
        "contains",
        "",
        "    !> Flow stress [Pa] and its slopes.",
        "    !@cuf attributes(host,device) &",
        "    pure subroutine flow_of(model, par, strain, rate, heat, y, slope, by_rate)",
        "        integer, intent(in) :: model !! code",
        "        real(rk), intent(in) :: par(n_par), strain, rate, heat !! plastic; heat_of",
        "        real(rk), intent(out) :: y, slope, by_rate !! [Pa], per strain, per rate",
        "",
        "        select case (model)",
    ]
    for m in metals:
        lines += m.lines(f"        case ({m.name})", f"            call flow_{m.name}({m.flow})")
    lines += [
        "        case default",
        "            y = 0",
        "            slope = 0",
        "            by_rate = 0",
        "        end select",
        "    end subroutine flow_of",
        "",
        "    !> What a flow stress takes of heat: the temperature, or what a metal makes of T*.",
        "    !@cuf attributes(host,device) &",
        "    pure function heat_of(model, par, hot, temperature) result(heat)",
        "        integer, intent(in) :: model !! code",
        "        real(rk), intent(in) :: par(n_par), hot, temperature !! T*, [K]",
        "        real(rk) :: heat",
        "",
        "        select case (model)",
    ]
    for m in metals:
        value = f"heat_{m.name}(par, hot)" if m.heat else "temperature"
        if m.warm():
            lines += m.lines(f"        case ({m.name})", f"            heat = {value}")
    warm = " .or. ".join(f"model == {m.name}" for m in metals if m.warm()) or ".false."
    lines += [
        "        case default",
        "            heat = 0",
        "        end select",
        "    end function heat_of",
        "",
        "    !> Whether a metal has a temperature.",
        "    !@cuf attributes(host,device) &",
        "    pure function feels_heat(model) result(yes)",
        "        integer, intent(in) :: model !! code",
        "        logical :: yes",
        "",
        f"        yes = {warm}",
        "    end function feels_heat",
    ]
    return lines


def kernels(models):
    """One kernel for each model: a kernel for all would need the registers of the largest."""
    names = [m.name for m in models]
    lines = [f"    use brz_{x}, only: {x}" for x in names]
    lines += [
        "    use brz_gpu_solid_layout, only: body_gpu_t",
        "    use brz_kinds, only: dp, int32, rk",
        "    use brz_solid_material_kernels, only: advance_point",
        "    implicit none",
        "    private",
        *(f"    public :: update_by_{x}" for x in names),
        "",
        "contains",
    ]
    for x, slots in ((m.name, m.slots) for m in models):
        lines += [
            "",
            f"    attributes(global) subroutine update_by_{x}(n, dt, tiles, bodies, grad, state, &",
            "        tag, diag, flags)",
            "        integer, value :: n",
            "        real(rk), value :: dt !! [s]",
            "        integer, device, intent(in) :: tiles(2, *)",
            "        type(body_gpu_t), device, intent(in) :: bodies(*)",
            "        real(rk), device, intent(in) :: grad(n, 9)",
            "        real(rk), device, intent(inout) :: state(n, *)",
            "        integer(int32), device, intent(inout) :: tag(n, *)",
            "        real(dp), device, intent(inout) :: diag(n, *)",
            "        integer, device, intent(inout) :: flags(*)",
            "",
            f"        call advance_point({x}, {slots}, n, dt, tiles, bodies, grad, state, &",
            "            tag, diag, flags)",
            f"    end subroutine update_by_{x}",
        ]
    return lines


def write(path, lines):
    head = ["! SPDX-License-Identifier: MIT", "!> Written by scripts/models.py from src/materials."]
    module = f"brz_{path.stem}"
    lines = [*head, f"module {module}", *lines, f"end module {module}"]
    after = [*lines[1:], ""]
    pairs = zip(lines, after, strict=True)
    lines = [x for x, y in pairs if x != RESUME or not y.startswith("# ")]
    lines = [f'# {n + 1} "{path}"' if x == RESUME else x for n, x in enumerate(lines, 1)]
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")


def main():
    folder = Path(sys.argv[1])
    models = sorted(m for m in map(model_of, map(Path, sys.argv[2:])) if m)
    codes = {m.code for m in models}
    if len(codes) < len(models):
        free = next(c for c in range(1, len(models) + 1) if c not in codes)
        sys.exit(f"models.py: two material models have the same code; {free} is free")
    write(folder / "model_list.f90", listed(models))
    write(folder / "flow_list.f90", flows([m for m in models if m.flow]))
    write(folder / "model_kernels.CUF", kernels(models))


main()
