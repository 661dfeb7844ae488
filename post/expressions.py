# SPDX-License-Identifier: MIT
"""Formulas of study files: numbers, names, + - * / **, sqrt, exp, log, min, max; nothing else."""

from __future__ import annotations

import ast
import math
import operator

from post.errors import USAGE, PostError

BINARY = {
    ast.Add: operator.add,
    ast.Sub: operator.sub,
    ast.Mult: operator.mul,
    ast.Div: operator.truediv,
    ast.Pow: operator.pow,
}
UNARY = {ast.USub: operator.neg, ast.UAdd: operator.pos}
CALLS = {"sqrt": math.sqrt, "exp": math.exp, "log": math.log, "min": min, "max": max}
NAMES = {"pi": math.pi}
LONGEST, LARGEST = 300, 1e30  # letters of a formula; magnitude of any number in it


def evaluate(text: str, names: dict[str, float | str], where: str) -> float | str:
    """Value of a formula; a text where it is one name alone that stands for a text.

    PostError, with file and line as in `where` and the column, for what is no such formula.
    """
    if len(text) > LONGEST:
        raise PostError(f"{where}: the formula is longer than {LONGEST} letters", USAGE)
    bare = text.strip()
    if isinstance(names.get(bare), str):
        return names[bare]
    try:
        tree = ast.parse(bare, mode="eval")
    except (SyntaxError, ValueError, RecursionError) as error:
        raise PostError(f"{where}: '{bare}' is no formula", USAGE) from error
    try:
        return _number(tree.body, NAMES | names)
    except _WrongError as error:
        place = f"column {error.column + 1}"
        raise PostError(f"{where}: '{bare}', {place}: {error}", USAGE) from error
    except (ArithmeticError, ValueError, TypeError) as error:
        raise PostError(f"{where}: '{bare}' has no value: {error}", USAGE) from error


class _WrongError(Exception):
    def __init__(self, text: str, node: ast.AST):
        super().__init__(text)
        self.column = getattr(node, "col_offset", 0)


def _number(node: ast.AST, names: dict) -> float:
    if isinstance(node, ast.Constant) and isinstance(node.value, (int, float)):
        value = float(node.value)
    elif isinstance(node, ast.Name):
        if isinstance(names.get(node.id), str) or node.id not in names:
            known = ", ".join(k for k, v in names.items() if not isinstance(v, str))
            raise _WrongError(f"no number is called '{node.id}'; there are {known}", node)
        value = float(names[node.id])
    elif isinstance(node, ast.BinOp) and type(node.op) in BINARY:
        value = BINARY[type(node.op)](_number(node.left, names), _number(node.right, names))
    elif isinstance(node, ast.UnaryOp) and type(node.op) in UNARY:
        value = UNARY[type(node.op)](_number(node.operand, names))
    elif isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and not node.keywords:
        if node.func.id not in CALLS:
            raise _WrongError(f"there is no function '{node.func.id}'", node)
        value = float(CALLS[node.func.id](*(_number(one, names) for one in node.args)))
    else:
        raise _WrongError("only numbers, names, + - * / ** and sqrt, exp, log, min, max", node)
    if isinstance(value, complex) or not abs(value) <= LARGEST:
        raise _WrongError("the number is too large", node)
    return value
