# SPDX-License-Identifier: MIT
"""Names that a test module must not have, as genuine pFUnit 4 has them.

Module funit of pFUnit makes public much more than the stand-in does, and the suite that its
preprocessor writes after a test module uses both without `only`. An entity of the test module with
one of these names, declared there or taken from another module, is an error of the compiler there.
"""

import re

# Public names of module funit (core, assertions, matchers, runner), in lower case.
FUNIT = set(
    [
        "abstractmatcher",
        "abstracttestparameter",
        "all_of",
        "allof",
        "any_of",
        "anyexceptions",
        "anyof",
        "array_with_size",
        "assert_that",
        "assertall",
        "assertany",
        "assertapprox",
        "assertequal",
        "assertexceptionraised",
        "assertfail",
        "assertfalse",
        "assertgreaterthan",
        "assertgreaterthanorequal",
        "assertisfinite",
        "assertisnan",
        "assertlessthan",
        "assertlessthanorequal",
        "assertnone",
        "assertnotall",
        "assertnotequal",
        "assertrelativelyequal",
        "assertsameshape",
        "asserttrue",
        "basetestrunner",
        "catch",
        "catchnext",
        "contains_string",
        "debuglistener",
        "disable",
        "empty_array",
        "ends_with",
        "equal_to",
        "every",
        "every_item",
        "expectation",
        "false",
        "finalize",
        "generic_run",
        "get_context",
        "greater_than",
        "ignore_all",
        "ignore_differences",
        "initialize",
        "is",
        "isarraywithsize",
        "isequal",
        "isgreater",
        "isnear",
        "isnear_32",
        "isnear_64",
        "isnot",
        "isrelativelynear",
        "istrueorfalse",
        "keep_all",
        "listenerpointer",
        "loadtests_interface",
        "matchable",
        "matcherdescription",
        "namefilter",
        "near",
        "not",
        "parallelcontext",
        "parameterizedtestcase",
        "predicate",
        "relatively_near",
        "remoterunner",
        "resultprinter",
        "robustrunner",
        "run",
        "serialcontext",
        "sourcelocation",
        "starts_with",
        "stringcontains",
        "stringdescription",
        "stringendswith",
        "stringstartswith",
        "stringtestannotationmap",
        "stub",
        "subject",
        "taplistener",
        "test",
        "testannotation",
        "testcase",
        "testlistener",
        "testlistenervector",
        "testmethod",
        "testresult",
        "testrunner",
        "testsuite",
        "throw",
        "timeoutannotation",
        "trim_all",
        "true",
        "wascalled",
        "wascalledonce",
        "wasnotcalled",
        "whitespaceoptions",
        "xmlprinter",
    ]
)
# Names of the suite function that the preprocessor writes.
SUITE = {"suite", "t"}

USE = re.compile(r"^use\b[^:]*?(?:::)?\s*(\w+)\s*,\s*only\s*:\s*(.*)$", re.I)
ENTITIES = re.compile(
    r"^(?:integer|real|logical|complex|character|double\s+precision|type\s*\(|class\s*\(|"
    r"procedure\s*\()[^:]*::\s*(.*)$",
    re.I,
)
TYPE = re.compile(r"^type\b(?!\s*\()(?:[^:]*::)?\s*(\w+)$", re.I)
INTERFACE = re.compile(r"^(?:abstract\s+)?interface\b\s*(\w*)", re.I)
PROCEDURE = re.compile(
    r"^(?!end\b)(?:[\w*(),= ]+\s)??(?:subroutine|function)\s+(\w+)\s*(?:\(|$)", re.I
)
END = re.compile(r"^end\s*(?:subroutine|function|type|interface)\b", re.I)


def at_top(text):
    """The text without what stands in brackets."""
    depth, out = 0, []
    for char in text:
        depth += char in "(["
        if depth == 0:
            out.append(char)
        depth -= char in ")]"
    return "".join(out)


def declared(statement):
    """Names that a statement of the specification part of a module gives to the module."""
    if found := USE.match(statement):
        return [part.split("=>")[0].strip() for part in at_top(found[2]).split(",")]
    if found := ENTITIES.match(statement):
        return [re.split(r"[=*]", part)[0].strip() for part in at_top(found[1]).split(",")]
    for rule in (TYPE, INTERFACE, PROCEDURE):
        if found := rule.match(statement):
            return [found[1]]
    return []


class ModuleNames:
    """Reads the statements of a test module one by one and finds names that clash."""

    def __init__(self):
        self.depth = 0

    def clash(self, statement):
        """What is wrong with a statement, or nothing."""
        statement = statement.strip()
        if END.match(statement):
            self.depth -= 1
            return ""
        names = declared(statement) if self.depth == 0 else []
        if any(rule.match(statement) for rule in (TYPE, INTERFACE, PROCEDURE)):
            self.depth += 1
        for name in (name.lower() for name in names):
            if name in FUNIT:
                return f"'{name}' is a public name of pFUnit: choose another"
            if name in SUITE:
                return f"'{name}' is a name of the suite that pFUnit writes: choose another"
        return ""
