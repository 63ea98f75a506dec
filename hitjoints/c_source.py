"""The compiled formulas as C, for loops that are not in Python."""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import TYPE_CHECKING

from hitjoints.built import chain_of, refused_by_name
from hitjoints.datasets.describe import versions
from hitjoints.errors import InputError

if TYPE_CHECKING:
    from hitjoints.model.robot import Contact, Robot

NAME = re.compile(r"[A-Za-z][A-Za-z0-9_]{0,62}")
KEYWORDS = frozenset((
    "auto", "break", "case", "char", "const", "continue", "default", "do", "double", "else",
    "enum", "extern", "float", "for", "goto", "if", "inline", "int", "long", "register",
    "restrict", "return", "short", "signed", "sizeof", "static", "struct", "switch", "typedef",
    "union", "unsigned", "void", "volatile", "while", "main", "reduced", "sine", "cosine",
))  # fmt: skip
SIZES = {"": "", "3": " (3)", "n": " ({n})", "3n": " (3 x {n}, row by row)"}


def c_source(
    robot: Robot,
    contact: Contact | int,
    outputs: Sequence[str] = ("inertia", "gradient"),
    name: str = "hit",
) -> str:
    """Return quantities of one contact as a function in C99, for a loop at 1 kHz in C or C++.

    It takes no memory and calls nothing but the C library's libm. `void NAME(const double *in,
    double *out)`: the text begins with what is in `in` and `out`. The same formulas as those of
    `Evaluator`, to which it is compared in the tests; q is not checked against the limits.

    Args:
        robot: the arm.
        contact: joint number or Contact.
        outputs: names, see `Evaluator`.
        name: of the function.

    Raises:
        InputError: no such joint or output, a speed of an arm without velocity limits, or no name
            for a function.
    """
    from hitjoints.kernels.outputs import OUTPUTS, known_outputs
    from hitjoints.kernels.single import record_single
    from hitjoints.kernels.tape.c_text import c_function

    if not NAME.fullmatch(name) or name in KEYWORDS:
        raise InputError("name", name, "letters, digits and _, a letter first, and no word of C")
    names = (outputs,) if isinstance(outputs, str) else tuple(outputs)
    if not names or len(set(names)) < len(names):
        raise InputError("outputs", names, "at least one, each once")
    known_outputs(names)
    where, chain = robot.contact(contact), chain_of(robot)
    with refused_by_name(robot):
        tape = record_single(chain, chain.attach(where.joint, where.offset), names)
    n = robot.n
    told = ", ".join(f"{each}{SIZES[OUTPUTS[each].shape].format(n=n)}" for each in names)
    title = re.sub(r"[*/\\]+", " ", robot.name)
    comment = (
        f"{name}: {title}, joint {where.joint}, offset {tuple(where.offset)} m\n"
        f" * written by {versions()}, robot {robot.digest}\n"
        f" * in: q ({n}) rad, hitting direction (3) of any length, mass of the object (kg)\n"
        " * out: status (2: fine, 1: the contact cannot move along the direction, the outputs\n"
        f" * hold their limits, 0: unusable input), {told}"
    )
    return c_function(tape, name, comment)
