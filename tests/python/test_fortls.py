# SPDX-License-Identifier: MIT
"""An editor with fortls finds every procedure that a line of the sources calls."""

import re
from pathlib import Path
from types import SimpleNamespace

import pytest
from fortls.interface import cli
from fortls.langserver import LangServer

ROOT = Path(__file__).parents[2]
CALL = re.compile(r"^ *(?:if \([^!]*\) )?call (\w+)\(")  # (not behind what looks like a comment)
# intrinsic procedures, C, HDF5 and OpenMP
ELSEWHERE = re.compile(
    r"move_alloc|get_command_argument|get_environment_variable|system_clock|c_f_\w+|h5\w+_f|omp_\w+"
)


@pytest.fixture(scope="module")
def server():
    """The language server with the sources of a built tree, as `.fortls` says."""
    quiet = SimpleNamespace(send_notification=lambda *_: None, send_request_batch=lambda *_: None)
    server = LangServer(conn=quiet, settings=vars(cli("fortls").parse_args([])))
    server.root_path = str(ROOT)
    server._load_config_file()
    server._resolve_globs_in_paths()
    server.workspace_init()
    return server


def calls(path):
    """Line, column and name of the first call of each procedure in a file."""
    seen = set()
    for number, line in enumerate(path.read_text(encoding="utf-8").splitlines()):
        found = CALL.match(line)
        if found and found[1] not in seen and not ELSEWHERE.fullmatch(found[1]):
            seen.add(found[1])
            yield number, found.start(1) + 1, found[1]


@pytest.mark.slow
def test_every_call_leads_to_its_procedure(server):
    lost, asked = [], 0
    for path in sorted((ROOT / "src").glob("**/*.?90")):
        for line, column, name in calls(path):
            asked += 1
            place = {"textDocument": {"uri": path.as_uri()}}
            place["position"] = {"line": line, "character": column}
            if not server.serve_definition({"params": place}):
                lost.append(f"{path.relative_to(ROOT)}:{line + 1}: {name}")
    assert asked > 2000 and not lost
