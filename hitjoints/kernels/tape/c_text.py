"""Write a program as a function in C99: doubles in, doubles out, no allocation, libm alone.

Sine and cosine are those of the LLVM text, so that the same program gives the same numbers, up to
which products the compiler fuses.
"""

from __future__ import annotations

import math
from collections.abc import Callable

from hitjoints.kernels.tape.llvm_text import COSINE, PI_PARTS, SINE
from hitjoints.kernels.tape.trace import Operand, Operation, Tape

SIGNS = {"add": "+", "sub": "-", "mul": "*", "div": "/"}
CALLS = {"abs": "fabs", "sqrt": "sqrt", "sin": "sine", "cos": "cosine"}
TURNS = """
/* x - k pi in [-pi/2, pi/2], and the sign of (-1)^k */
static double reduced(double x, double *sign)
{{
    const double k = rint(x * {inverse});
    const double half = 0.5 * k - rint(0.5 * k);
    *sign = 1.0 - 8.0 * half * half;
    return fma(k, -{second}, fma(k, -{first}, x));
}}
"""


def c_function(program: Tape, name: str, comment: str) -> str:
    """Return the text of a file with one function, void NAME(const double *in, double *out).

    Args:
        program: what it computes.
        name: of the function, an identifier.
        comment: the first lines of the file, without what would end a comment.
    """
    used = {operation.name for operation in program.operations}
    first, second = (_number(part) for part in PI_PARTS)
    turns = TURNS.format(inverse=_number(1.0 / math.pi), first=first, second=second)
    series = [
        _series(function, coefficients)
        for function, coefficients in (("sine", SINE), ("cosine", COSINE))
        if {"sine": "sin", "cosine": "cos"}[function] in used
    ]
    lines = [f"/* {comment} */", "#include <math.h>"]
    lines += [turns, *series] if series else []
    lines += ["", f"void {name}(const double *in, double *out)", "{"]

    def value(operand: Operand) -> str:
        if not isinstance(operand, int):
            return _number(operand)
        given = program.inputs
        return f"in[{operand}]" if operand < given else f"v{operand - given}"

    for step, operation in enumerate(program.operations):
        lines.append(f"    const double v{step} = {_expression(operation, value)};")
    lines += [f"    out[{k}] = {value(output)};" for k, output in enumerate(program.outputs)]
    return "\n".join([*lines, "}", ""])


def _expression(operation: Operation, value: Callable[[Operand], str]) -> str:
    name, operands = operation.name, [value(operand) for operand in operation.operands]
    if name in SIGNS:
        return f"{operands[0]} {SIGNS[name]} {operands[1]}"
    if name == "neg":
        return f"-{operands[0]}"
    if name in CALLS:
        return f"{CALLS[name]}({operands[0]})"
    a, b = operands[:2]
    if name == "select":
        return f"{a} < {b} ? {operands[2]} : {operands[3]}"
    return f"{a} < {b} ? {a} : {b}" if name == "min" else f"{b} < {a} ? {a} : {b}"


def _series(name: str, coefficients: tuple[float, ...]) -> str:
    text = _number(coefficients[-1])
    for coefficient in reversed(coefficients[:-1]):
        text = f"fma({text}, s, {_number(coefficient)})"
    scale = "sign * r" if name == "sine" else "sign"
    return (
        f"\nstatic double {name}(double x)\n{{\n    double sign;\n"
        f"    const double r = reduced(x, &sign), s = r * r;\n    return {text} * ({scale});\n}}"
    )


def _number(value: float) -> str:
    """A constant, to the last bit."""
    if math.isnan(value):
        return "NAN"
    if math.isinf(value):
        return "INFINITY" if value > 0 else "(-INFINITY)"
    text = repr(float(value))
    return f"({text})" if value < 0 else text
