#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Print modules funit (the assertions for every type, kind and rank of the subset) and pfunit."""

KINDS = {"i4": "integer", "i8": "integer(int64)", "r4": "real(real32)", "r8": "real(real64)"}
PAIRS = [("i4", "i4"), ("i4", "i8"), ("i8", "i8"), ("r4", "r4"), ("r4", "r8"), ("r8", "r8")]
RANKS = [(0, 0), (0, 1), (1, 1), (0, 2), (2, 2)]
DIMS = {0: "", 1: "(:)", 2: "(:, :)"}
OPS = {
    "assertEqual": "op_equal",
    "assertNotEqual": "op_not_equal",
    "assertLessThan": "op_less",
    "assertLessThanOrEqual": "op_less_equal",
    "assertGreaterThan": "op_greater",
    "assertGreaterThanOrEqual": "op_greater_equal",
    "assertRelativelyEqual": "op_relative",
}
HEAD = """! SPDX-License-Identifier: MIT
!> The assertions of the subset of pFUnit. Written by tests/pfstub/write_funit.py: do not edit.
module funit
    use, intrinsic :: iso_fortran_env, only: int64, real32, real64
    use, intrinsic :: ieee_arithmetic, only: ieee_is_nan, ieee_is_finite
    use pf_core, only: SourceLocation, TestSuite, anyExceptions, throw, compare_reals, &
        compare_integers, op_equal, op_not_equal, op_less, op_less_equal, op_greater, &
        op_greater_equal, op_relative
    implicit none
    private
    public :: SourceLocation, TestSuite, anyExceptions"""
TAIL_ARGS = """        character(*), intent(in), optional :: message
        type(SourceLocation), intent(in) :: location
"""


def flat(name, rank, kind):
    wide = (
        f"{'int' if kind[0] == 'i' else 'real'}({name}, {'int64' if kind[0] == 'i' else 'real64'})"
    )
    return f"[{wide}]" if rank == 0 else f"reshape({wide}, [size({name})])"


def comparison(name, op, pair, ranks, strict=True):
    real = pair[0][0] == "r"
    tolerant = real and name in ("assertEqual", "assertRelativelyEqual")
    label = f"{op}_{pair[0]}{pair[1]}_{ranks[0]}{ranks[1]}"
    args = "expected, actual, " + ("tolerance, " if tolerant else "") + "message, location"
    lines = [f"    subroutine {label}({args})"]
    for what, kind, rank in zip(("expected", "actual"), pair, ranks, strict=True):
        lines.append(f"        {KINDS[kind]}, intent(in) :: {what}{DIMS[rank]}")
    if tolerant:
        lines.append(f"        {KINDS[pair[1]]}, intent(in), optional :: tolerance")
    lines.append(TAIL_ARGS)
    if tolerant:
        lines.append("        real(real64) :: bound\n\n        bound = 0")
        lines.append("        if (present(tolerance)) bound = tolerance")
    sides = [
        f"{flat(w, r, k)}, shape({w})"
        for w, k, r in zip(("expected", "actual"), pair, ranks, strict=True)
    ]
    core = "compare_reals" if real else "compare_integers"
    extra = (" bound," if tolerant else "") + " message=message, location=location)"
    lines.append(f"        call {core}({op}, {sides[0]}, &\n            {sides[1]},{extra}")
    lines.append(f"    end subroutine {label}\n")
    return label, "\n".join(lines)


def condition(name, label, declare, test, text):
    """An assertion on one argument."""
    return label, "\n".join(
        [
            f"    subroutine {label}(actual, message, location)",
            f"        {declare}",
            TAIL_ARGS,
            f"        if (.not. ({test})) call throw('{text}', message, location)",
            f"    end subroutine {label}\n",
        ]
    )


def pair_of(label, declare, test, text):
    return label, "\n".join(
        [
            f"    subroutine {label}(expected, actual, message, location)",
            f"        {declare}, intent(in) :: expected, actual",
            TAIL_ARGS,
            f"        if (.not. ({test})) call throw({text}, message, location)",
            f"    end subroutine {label}\n",
        ]
    )


def all_assertions():
    found = {}
    for name, op in OPS.items():
        pairs = [p for p in PAIRS if p[0][0] == "r" or name != "assertRelativelyEqual"]
        found[name] = [comparison(name, op, p, r) for p in pairs for r in RANKS]
    strings = "'expected <'//expected//'> but found <'//actual//'>'"
    found["assertEqual"] += [
        pair_of("equal_text", "character(*)", "expected == actual", strings),
        pair_of("equal_logical", "logical", "expected .eqv. actual", "'the logicals differ'"),
    ]
    logical = "logical, intent(in) :: actual"
    for name, test, text in (
        ("assertTrue", "actual", "expected true"),
        ("assertFalse", ".not. actual", "expected false"),
    ):
        found[name] = [condition(name, f"{name}_0", logical, test, text)]
    for name, test, text in (
        ("assertAll", "all(actual)", "expected all to be true"),
        ("assertAny", "any(actual)", "expected one to be true"),
        ("assertNone", ".not. any(actual)", "expected none to be true"),
    ):
        found[name] = [condition(name, f"{name}_1", logical + DIMS[1], test, text)]
    for name, call in (("assertIsNan", "ieee_is_nan"), ("assertIsFinite", "ieee_is_finite")):
        test = f"{call}(actual)"
        found[name] = [
            condition(name, f"{name}_{kind}", f"{KINDS[kind]}, intent(in) :: actual", test, call)
            for kind in ("r4", "r8")
        ]
    fail = "    subroutine fail(message, location)\n        character(*), intent(in) :: message\n"
    fail += "        type(SourceLocation), intent(in) :: location\n\n"
    fail += "        call throw(message, location=location)\n    end subroutine fail\n"
    found["assertFail"] = [("fail", fail)]
    return found


if __name__ == "__main__":
    assertions = all_assertions()
    print(HEAD)
    for generic, items in assertions.items():
        print(f"    public :: {generic}")
        print(f"    interface {generic}")
        for label, _ in items:
            print(f"        module procedure {label}")
        print(f"    end interface {generic}")
    print("\ncontains\n")
    for items in assertions.values():
        for _, body in items:
            print(body)
    print("end module funit")
    print(
        """
!> What tests on several processes use: all of funit, and what they are given.
module pfunit
    use funit
    use pf_core, only: MpiTestMethod
    implicit none
    public
end module pfunit"""
    )
