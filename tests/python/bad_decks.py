# SPDX-License-Identifier: MIT
"""Decks that must be refused: name, text, words that the message must hold.

Each deck is a good one with one fault put in, so that a test fails if the fault is not seen.
`line` is the number of the line that the message must name; None where the fault has no line.
"""

from dataclasses import dataclass, field

GOOD = """\
A blast on a plate that stands on edge.
&run title='good', t_end=1e-4 /
&air
  box = 0,0.4, 0,0.4, 0,0.4
  cells = 20,20,20
/
&charge id='c1', mass=1.5, at=0.2,0.2,0.2 /
&material id='steel', model='linear_elastic', density=7850, youngs_modulus=2e11, poisson_ratio=0.3 /
&body id='plate', box=0.05,0.07, 0.1,0.3, 0.1,0.3, spacing=0.01, material='steel' /
&gauge id='g1', at=0.3,0.2,0.2 /
&gauge id='g2', at=0.06,0.2,0.2, quantity='displacement_x', body='plate' /
&output dump_every=1e-5 /
"""


@dataclass
class Bad:
    """A deck with a fault, and what the program must say of it."""

    name: str
    text: bytes
    line: int | None
    words: list[str] = field(default_factory=list)


def swap(name, old, new, line, *words):
    """Give the good deck a fault."""
    assert GOOD.count(old) == 1, f"{name}: {old!r} stands {GOOD.count(old)} times in the good deck"
    return Bad(name, GOOD.replace(old, new).encode(), line, list(words))


def whole(name, text, line, *words):
    """A deck that is wrong as a whole."""
    return Bad(name, text if isinstance(text, bytes) else text.encode(), line, list(words))


def pseudo_random_bytes(n):
    """Bytes of all values, the same at every run."""
    state, out = 12345, bytearray()
    for _ in range(n):
        state = (1103515245 * state + 12345) % 2**31
        out.append(state >> 16 & 255)
    return bytes(out)


def flat(keys):
    """A strip in two dimensions, with more keys."""
    body = f"&body id='a', box=0,0.01, 0,0.004, 0,1, spacing=1e-3, material='m', {keys} /"
    return f"&run t_end=1e-6, dimension=2 /\n&material id='m', preset='al2024' /\n{body}\n"


PLATE = "box=0.05,0.07, 0.1,0.3, 0.1,0.3"

BAD = [
    # what comes in
    swap("no_gas", "&output", "&inflow face='x-' /\n&output", 12, "what comes in?"),
    swap("no_room", "&output", "&solid region=0,1, 1,0, 0,1 /\n&output", 12, "region has no room"),
    whole("velocity_nowhere", flat("velocity=0,0,1"), 3, "no direction z", "velocity 0"),
    whole("pushed_nowhere", flat("fix='all', motion_time=0, motion_velocity=0,0,1"), 3, "on z;"),
    whole(
        "blown_nowhere",
        flat("") + "&air box=0,1, 0,1, 0,1, cells=8,8,1 /\n"
        "&gas id='g', box=0,1, 0,1, 0,1, density=1, pressure=1, velocity=0,0,1 /",
        5,
        "no direction z",
    ),
    swap("no_equals_of_model", "density=7850", "density 7850", 8, "one text", "a '=' missing"),
    whole("spin_nowhere", flat("spin=1,0,0"), 3, "turns about z alone"),
    whole("face_nowhere", flat("fix='z-'"), 3, "no face 'z-'", "out of fix"),
    swap(
        "two_kinds",
        "&output",
        "&inflow face='x-', overpressure=1e5, mach=2 /\n&output",
        12,
        "take one of them out",
    ),
    swap(
        "closed_face",
        "cells = 20,20,20",
        "cells = 20,20,20, bc='wall' /\n&inflow face='x-', mach=2",
        6,
        "bc='outflow'",
        "found 'wall'",
    ),
    swap(
        "few_states",
        "&output",
        "&inflow face='x-', time=0,1,2, mach=2,3 /\n&output",
        12,
        "2 values of mach for 3 times",
    ),
    swap(
        "same_face",
        "&output",
        "&inflow face='x-', mach=2 /\n&inflow face='x-', mach=3 /\n&output",
        13,
        "another &inflow has this face",
    ),
    swap(
        "below_vacuum", "&output", "&inflow face='y+', overpressure=-2e5 /\n&output", 12, "vacuum"
    ),
    swap("no_history", "&output", "&inflow face='y+', table='no.csv' /\n&output", 12, "no.csv"),
    swap(
        "inflow_before_the_box",
        "at=0.2,0.2,0.2 /",
        "at=0.2,0.2,0.2, start='1d' /\n&inflow face='y+', mach=1 /",
        8,
        "start='3d'",
    ),
    # gas from a file
    swap(
        "gas_twice",
        "&output",
        "&gas id='g', file='a.csv', density=1 /\n&output",
        12,
        "take density out",
    ),
    swap("half_a_gas", "&output", "&gas id='g', density=1 /\n&output", 12, "needs box, density"),
    swap(
        "no_gas_file", "&output", "&gas id='g', file='a.vtkhdf' /\n&output", 12, "there is no file"
    ),
    swap("moved_box", "&output", "&gas id='g', move=1,0,0 /\n&output", 12, "belong to a file"),
    # type
    swap("word_for_real", "t_end=1e-4", "t_end=abc", 2, "t_end", "a number > 0.0 [s]", "'abc'"),
    swap("text_for_real", "t_end=1e-4", "t_end='1e-4'", 2, "t_end", "take the quotes off"),
    swap("real_for_integer", "cells = 20,20,20", "cells = 20.5,20,20", 5, "cells", "integers"),
    swap("number_for_text", "title='good'", "title=3.5", 2, "title", "text in quotes"),
    swap("no_quotes", "material='steel'", "material=steel", 9, "without quotes"),
    swap("number_for_logical", "cells =", "fallback=7, cells =", 5, "fallback", "logical"),
    swap("hex_number", "spacing=0.01", "spacing=0x1F", 9, "spacing", "'0x1F'"),
    swap("unit_in_number", "spacing=0.01", "spacing=10mm", 9, "spacing", "'10mm'"),
    swap("decimal_comma", "mass=1.5", "mass=1,5", 7, "mass", "1.5"),
    swap("fraction", "mass=1.5", "mass=3/2", 7, "write fractions as numbers"),
    swap(
        "half_motion", "material='steel' /", "material='steel', motion_time=0 /", 9, "three numbers"
    ),
    swap(
        "motion_of_nothing",
        "material='steel' /",
        "material='steel', motion_time=0, motion_velocity=1,0,0 /",
        9,
        "formulation='rigid'",
    ),
    swap("no_file", PLATE, "shape='stl', file='nothing.stl'", 9, "there is no file 'nothing.stl'"),
    # interactions
    swap(
        "meet_nobody",
        "&output",
        "&interaction law='none', bodies='plates' /\n&output",
        12,
        "did you",
    ),
    swap(
        "meet_itself",
        "&output",
        "&interaction law='none', bodies=2*'plate' /\n&output",
        12,
        "itself",
    ),
    swap(
        "no_bond",
        "&output",
        "&interaction law='contact', shear_strength=1e6 /\n&output",
        12,
        "shear_strength",
        "no place with law='contact'",
    ),
    # bodies
    swap("cuts_nobody", "material='steel' /", "material='steel', cuts='slab' /", 9, "'slab'"),
    swap("cuts_itself", "material='steel' /", "material='steel', cuts='plate' /", 9, "cut each"),
    swap("odd_region", "material='steel' /", "material='steel', fix_box=1,2,3,4,5,6,7 /", 9, "six"),
    swap(
        "no_pipe",
        PLATE,
        "shape='cylinder', centre=3*0.2, radius=0.05, length=0.1, inner_radius=0.05",
        9,
        "leaves nothing",
    ),
    swap("key_of_bars", PLATE, PLATE + ", diameter=0.01", 9, "diameter", "no place"),
    swap(
        "crowded_bars",
        PLATE,
        PLATE + ", shape='bars', axis='y', diameter=0.012, bars=1,2",
        9,
        "2 bars of 0.012 m do not fit between x=0.05 and 0.07",
    ),
    # range
    swap("negative_density", "density=7850", "density=-7850", 8, "density", "[kg/m3]", "-7850"),
    swap("zero_t_end", "t_end=1e-4", "t_end=0", 2, "> 0.0 [s]"),
    swap("zero_cells", "20,20,20", "20,0,20", 5, "cells", ">= 1"),
    swap("negative_cells", "20,20,20", "20,20,-20", 5, "cells", ">= 1"),
    swap("poisson", "poisson_ratio=0.3", "poisson_ratio=0.7", 8, "0.7"),
    swap("nan", "t_end=1e-4", "t_end=NaN", 2, "not a finite number"),
    swap("infinity", "mass=1.5", "mass=Inf", 7, "not a finite number"),
    swap("real_overflow", "mass=1.5", "mass=1e999", 7, "too large"),
    swap("integer_overflow", "20,20,20", "20,20,99999999999", 5, "too large", "2147483647"),
    swap("huge_repeat", "20,20,20", "999999999999*20", 5, "found 100000000 values"),
    # names
    swap("unknown_key", "density=7850", "densty=7850", 8, "'densty'", "'density' [kg/m3]"),
    swap("unknown_group", "&gauge id='g1'", "&guage id='g1'", 10, "&guage", "did you mean &gauge"),
    swap("unknown_choice", "mass=1.5", "shape='spere', mass=1.5", 7, "did you mean 'sphere'"),
    swap("unknown_model", "linear_elastic", "linear_elastc", 8, "did you mean 'linear_elastic'"),
    swap("unknown_material", "material='steel'", "material='steal'", 9, "'steal'", "'steel'"),
    swap("unknown_body", "body='plate'", "body='plat'", 11, "'plat'", "'plate'"),
    swap("unknown_quantity", "quantity='displacement_x'", "quantity='displ_x'", 11, "quantity"),
    swap("key_of_other_group", "t_end=1e-4", "t_end=1e-4, cells=1,1,1", 2, "it is a key of &air"),
    swap("subscript", "cells = 20,20,20", "cells(1) = 20", 5, "without index"),
    swap("no_group_name", "&air", "&", 3, "unknown group"),
    swap("old_end", "&gauge id='g1'", "&end\n&gauge id='g1'", 10, "close a group with '/'"),
    # form
    swap("missing_slash", "cells = 20,20,20\n/", "cells = 20,20,20\n", 3, "'/'", "line 7"),
    swap(
        "times_of_dumps_fall", "dump_every=1e-5", "dump_times=2e-5,1e-5", 12, "dump_times", "grow"
    ),
    swap("from_without_every", "dump_every=1e-5", "dump_from=2e-5", 12, "dump_from", "dump_every"),
    swap("missing_last_slash", "dump_every=1e-5 /", "dump_every=1e-5", 12, "end of the deck"),
    swap("open_quote", "title='good'", "title='good", 2, "quote"),
    swap("no_equals", "spacing=0.01", "spacing 0.01", 9, "missing behind 'spacing'"),
    swap("only_name", "t_end=1e-4", "t_end=", 2, "t_end", "nothing stands behind '='"),
    swap("double_comma", "20,20,20", "20,,20", 5, "cells", "an empty value"),
    swap("value_before_key", "title='good'", "5 title='good'", 2, "belongs to no key"),
    swap("stray_equals", "t_end=1e-4", "t_end==1e-4", 2, "'='"),
    swap("too_few_values", "20,20,20", "20,20", 5, "3 integers", "found 2 values"),
    swap("too_many_values", "at=0.3,0.2,0.2", "at=0.3,0.2,0.2,0.2", 10, "found 4 values"),
    swap("six_or_one_word", "cells =", "bc='wall','wall', cells =", 5, "one word for all faces"),
    whole("group_in_text", GOOD + "# &gauge id='g3', at=0.3,0.2,0.2 /\n", 13, "within text", "'!'"),
    whole("output_twice", GOOD + "&output dump_every=1e-5 /\n", 13, "may stand once", "line 12"),
    swap("duplicate_key", "t_end=1e-4", "t_end=1e-4, t_end=2e-4", 2, "stands twice"),
    swap("duplicate_group", "&output", "&run t_end=1 /\n&output", 12, "line 2"),
    swap("duplicate_id", "&gauge id='g2'", "&gauge id='g1'", 11, "taken", "line 10"),
    swap("bad_id", "id='plate'", "id='my plate'", 9, "letters, digits"),
    swap("long_value", "t_end=1e-4", "t_end=1" + 5000 * "0", 2, "longer than 2048"),
    # what is missing
    swap("missing_key", ", t_end=1e-4", "", 2, "'t_end' is missing"),
    swap("missing_model", ", model='linear_elastic'", "", 8, "'model' is missing"),
    swap("missing_model_key", ", density=7850", "", 8, "'density' is missing"),
    swap("missing_box", f"{PLATE}, ", "", 9, "'box' is missing", "shape='box'"),
    whole("no_run", GOOD.replace("&run", " run"), None, "&run is missing"),
    whole("nothing_to_do", "&run t_end=1 /\n", None, "neither &air nor &body"),
    # geometry
    swap("air_inside_out", "0,0.4, 0,0.4, 0,0.4", "0,0.4, 0.4,0, 0,0.4", 4, "ends at y=0.0"),
    swap("body_inside_out", PLATE, "box=0.07,0.05, 0.1,0.3, 0.1,0.3", 9, "ends at x=0.05"),
    swap("body_outside_air", PLATE, "box=1.05,1.07, 0.1,0.3, 0.1,0.3", 9, "outside the air"),
    swap("coarse_body", "spacing=0.01", "spacing=0.5", 9, "larger than the body"),
    swap("too_fine_body", "spacing=0.01", "spacing=1e-9", 9, "particles"),
    swap("too_many_cells", "20,20,20", "3*100000", 5, "more than 2147483647"),
    swap("key_of_other_shape", "spacing=", "radius=0.1, spacing=", 9, "shape='box'"),
    swap("charge_outside", "at=0.2,0.2,0.2", "at=0.2,0.2,9", 7, "outside the air"),
    swap("charge_without_cells", "mass=1.5", "mass=1e-6", 7, "cells lie across its radius"),
    swap(
        "afterburn_in_a_box",
        "mass=1.5",
        "mass=1.5, afterburn=1e7, afterburn_time=1e-3",
        7,
        "do not burn on",
        "geometry='spherical'",
    ),
    swap("afterburn_without_end", "mass=1.5", "mass=1.5, afterburn=1e7", 7, "afterburn_time"),
    swap(
        "jwl_in_3d",
        "mass=1.5",
        "mass=1.5, eos='jwl'",
        7,
        "one or two dimensions only",
        "start='1d'",
    ),
    swap("shape_of_start", "mass=1.5", "mass=1.5, start='1d', shape='box'", 7, "'2d' or '3d'"),
    swap(
        "box_in_a_plane", "mass=1.5", "mass=1.5, start='2d', shape='box'", 7, "sphere or a cylinder"
    ),
    swap("ignition_without", "mass=1.5", "mass=1.5, ignition=3*0.2", 7, "ignition", "start='2d'"),
    swap(
        "ignition_beside_the_axis",
        "mass=1.5",
        "mass=1.5, start='2d', eos='jwl', ignition=0.21,0.2,0.2",
        7,
        "on the axis along z",
    ),
    swap("floor_in_a_box", "  cells", "  floor = 0\n  cells", None, "in a box use bc"),
    swap(
        "two_starts",
        "&charge",
        "&charge id='c0', mass=1, at=3*0.2 /\n&charge start='1d',",
        8,
        "single charge",
    ),
    swap("box_of_sphere", "&air", "&air geometry='spherical',", 4, "takes no box"),
    swap("body_in_sphere", "&air", "&air geometry='planar',", 3, "has no room for &body"),
    swap("missing_cells", "cells = 20,20,20", "", 3, "'cells' is missing", "geometry"),
    whole(
        "sphere_without_charge",
        "&run t_end=1 /\n&air geometry='spherical' /",
        2,
        "needs one &charge",
    ),
    whole(
        "direction_in_sphere",
        "&run t_end=1 /\n&air geometry='spherical' /\n&charge id='c', mass=1, at=3*0 /\n"
        "&gauge id='g', at=1,0,0, quantity='velocity_x' /",
        4,
        "measure the speed",
    ),
    swap(
        "gauge_rigid",
        "'steel' /\n&gauge id='g1', at=0.3,0.2,0.2 /\n&gauge id='g2', at=0.06,0.2,0.2,"
        " quantity='displacement_x'",
        "'steel', formulation='rigid' /\n&gauge id='g1', "
        "at=0.3,0.2,0.2 /\n&gauge id='g2', at=0.06,0.2,0.2, quantity='stress_xx'",
        11,
        "no stress_xx",
    ),
    swap(
        "box_inside_out",
        "material='steel' /",
        "material='steel', fix_box=1,0,0,1,0,1 /",
        9,
        "ends before it begins",
    ),
    swap("gauge_damage", "'displacement_x'", "'damage'", 11, "no strength"),
    swap(
        "gauge_alone",
        "at=0.06,0.2,0.2, quantity='displacement_x'",
        "quantity='contact_x'",
        11,
        "no other body",
    ),
    swap(
        "gauge_unheld",
        "at=0.06,0.2,0.2, quantity='displacement_x'",
        "quantity='reaction_x'",
        11,
        "nothing holds",
    ),
    swap("gauge_outside", "at=0.3,0.2,0.2", "at=-0.3,0.2,0.2", 10, "outside the air"),
    swap("gauge_off_body", "at=0.06,0.2,0.2", "at=0.3,0.2,0.2", 11, "outside the body"),
    swap("gauge_needs_body", ", body='plate'", "", 11, "add body"),
    swap(
        "symmetry_box",
        "t_end=1e-4 /\n&air\n  box = 0,0.4",
        "t_end=1e-4, symmetry='x' /\n&air\n  box = 0.01,0.4",
        4,
        "must start at x=0",
    ),
    swap("bad_plies", "material='steel'", "material='steel', plies='0/9o'", 9, "plies"),
    swap("dimension", "t_end=1e-4", "t_end=1e-4, dimension=2", 5, "1 cell along z"),
    whole(
        "charge_without_air", "&run t_end=1 /\n&charge id='a', mass=1, at=3*0 /", 2, "needs &air"
    ),
    swap(
        "width_without_face", "spacing=0.01", "spacing=0.01, fix_width=0.02", 9, "add fix='sides'"
    ),
    swap(
        "width_and_layers",
        "spacing=0.01",
        "spacing=0.01, fix='x-', fix_width=0.02, fix_layers=2",
        9,
        "keep one",
    ),
    swap(
        "width_of_nothing",
        "spacing=0.01",
        "spacing=0.01, fix='x-', fix_width=0.004",
        9,
        "holds no particle",
    ),
    # hostile files
    whole("empty", b"", None, "empty"),
    whole("only_blanks", b" \n\n  \n", None, "no group"),
    whole("only_prose", b"This is a letter and not a deck.\n" * 20, None, "no group"),
    whole("long_line", b"x" * 10_000_000, None, "no group"),
    whole("long_line_of_values", b"&run t_end=" + b"1," * 5_000_000, 1, "found 5000000 values"),
    whole("long_line_of_keys", b"&run " + b"a=1 " * 2_500_000, 1, "more than 200 keys"),
    whole(
        "forgotten_slash",
        "&run t_end=1 /\n&air box=0,1,0,1,0,1, cells=2,2,2\n" + "cfl=0.5\n" * 199 + "/\n",
        2,
        "more than 200 keys, up to line 201: is a '/' missing?",
    ),
    whole("long_word", b"&run t_end=" + b"1" * 10_000_000, 1, "longer than 2048"),
    whole("long_quote", b"&run title='" + b"a" * 10_000_000, 1, "quote"),
    whole("many_groups", b"&run\n" * 1_000_000, 1, "missing"),
    whole("many_unknown_groups", b"&nonsense /\n" * 9_000, 1, "&nonsense"),
    whole("binary", pseudo_random_bytes(100_000), 1, "not a plain text file"),
    whole("binary_in_group", b"&run title='" + pseudo_random_bytes(1000), 1, "not a plain text"),
    whole("nul_bytes", b"&run t_end=1\0\0\0 /\n", 1, "not a plain text file", "code 0"),
    whole("zeros", bytes(1_000_000), 1, "not a plain text file"),
    whole("compressed", b"\x1f\x8b\x08\x00" + pseudo_random_bytes(5000), 1, "not a plain text"),
    whole("latin_1", b"&r\xfcn t_end=1 /\n", 1, "unknown group"),
]
