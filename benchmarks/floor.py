"""What the processor could do at best, and how close a kernel comes."""

from __future__ import annotations

import ctypes
from functools import cache

import numpy as np

from benchmarks.harness import seconds
from hitjoints.kernels import Kernel
from hitjoints.kernels.tape.llvm_backend import compile_function, host_lanes

SINE_OR_COSINE = 17  # instructions of one series, with its half of the argument reduction
CHAINS = 12  # independent sums that hide the latency of one fused multiply-add
ROUNDS = 20_000_000


def operations(kernel: Kernel) -> int:
    """Return the floating-point operations of one evaluation."""
    names = [operation.name for operation in kernel.runnable.program.operations]
    return len(names) + (SINE_OR_COSINE - 1) * (names.count("sin") + names.count("cos"))


@cache
def peak() -> float:
    """Floating-point operations per second of one core: a loop of fused multiply-adds, two each."""
    lanes = host_lanes()
    t = f"<{lanes} x double>"
    one = "<" + ", ".join(["double 1.0"] * lanes) + ">"
    phis = [f"%a{k} = phi {t} [ {one}, %entry ], [ %b{k}, %loop ]" for k in range(CHAINS)]
    steps = [
        f"%b{k} = call {t} @llvm.fma.v{lanes}f64({t} %a{k}, {t} %x, {t} %x)" for k in range(CHAINS)
    ]
    sums = [f"%s{k + 1} = fadd {t} {f'%s{k}' if k else one}, %b{k}" for k in range(CHAINS)]
    text = "\n".join(
        [
            f"declare {t} @llvm.fma.v{lanes}f64({t}, {t}, {t})",
            "define void @run(ptr %p, i64 %n) {",
            f"entry:\n%x = load {t}, ptr %p, align 8\nbr label %loop\nloop:",
            "%i = phi i64 [ 0, %entry ], [ %next, %loop ]",
            *phis,
            *steps,
            "%next = add i64 %i, 1\n%more = icmp slt i64 %next, %n",
            "br i1 %more, label %loop, label %end\nend:",
            *sums,
            f"store {t} %s{CHAINS}, ptr %p, align 8\nret void\n}}",
        ]
    )
    run, _keep = compile_function(text, ctypes.CFUNCTYPE(None, ctypes.c_void_p, ctypes.c_int64))
    values = np.full(lanes, 0.5)
    best = min(seconds(lambda: run(values.ctypes.data, ROUNDS)) for _ in range(3))
    return 2.0 * lanes * CHAINS * ROUNDS / best
