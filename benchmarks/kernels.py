"""Batch kernels against Pinocchio loops on this machine: run `python benchmarks/kernels.py`."""

from __future__ import annotations

import argparse
import ctypes
import json
import time
from collections.abc import Callable
from typing import Any

import numpy as np
import pinocchio as pin
from rich.console import Console
from rich.table import Table

from hitjoints.kernels import build_kernel, place
from hitjoints.kernels.llvm_backend import compile_function, host_lanes
from hitjoints.kernels.rows import available_cpus
from hitjoints.kernels.verify import Reference, samples
from hitjoints.loading import load_robot

H = np.array([0.0, 1.0, 0.0])
WORLD = pin.LOCAL_WORLD_ALIGNED
ORIGIN = (0.0, 0.0, 0.0)
CASES: dict[str, tuple[list[tuple[int, tuple[float, float, float]]], tuple[str, ...]]] = {
    "inertia": ([(6, ORIGIN)], ("inertia",)),
    "inertia, gradient": ([(6, ORIGIN)], ("inertia", "gradient")),
    "inertia, speed, flux, position; 3 joints": (
        [(5, ORIGIN), (6, ORIGIN), (7, ORIGIN)],
        ("inertia", "speed", "flux", "position"),
    ),
    "straight speed": ([(6, ORIGIN)], ("straight_speed",)),
}
SINE_OR_COSINE = 17  # instructions of one series, with its half of the argument reduction
CHAINS = 12  # independent sums that hide the latency of one fused multiply-add


def seconds(work: Callable[[], Any], repeats: int) -> float:
    """Least wall time of some runs."""
    times = []
    for _ in range(repeats):
        start = time.perf_counter()
        work()
        times.append(time.perf_counter() - start)
    return min(times)


def pinocchio_inertia(model: pin.Model, q: Any, joint: int) -> list[float]:
    data = model.createData()
    result = []
    for row in q:
        pin.crba(model, data, row)
        pin.computeJointJacobians(model, data, row)
        g = pin.getJointJacobian(model, data, joint, WORLD)[:3].T @ H
        pin.cholesky.decompose(model, data)
        result.append(1.0 / (g @ pin.cholesky.solve(model, data, g)))
    return result


def pinocchio_gradient(model: pin.Model, q: Any, joint: int) -> list[Any]:
    model = model.copy()
    model.gravity = pin.Motion.Zero()
    data, still, frame = model.createData(), np.zeros(model.nv), pin.SE3.Identity()
    result = []
    for row in q:
        pin.crba(model, data, row)
        pin.computeJointJacobians(model, data, row)
        g = pin.getJointJacobian(model, data, joint, WORLD)[:3].T @ H
        pin.cholesky.decompose(model, data)
        u = pin.cholesky.solve(model, data, g)
        inertia = 1.0 / (g @ u)
        pin.computeForwardKinematicsDerivatives(model, data, row, u, still)
        dv = pin.getPointVelocityDerivatives(model, data, joint, frame, WORLD)[0]
        dMu = pin.computeRNEADerivatives(model, data, row, still, u)[0]
        result.append(-(inertia**2) * (2.0 * H @ dv - u @ dMu))
    return result


def pinocchio_ik(model: pin.Model, targets: Any, joint: int) -> int:
    """Damped least squares with restarts, target after target; returns how many are solved."""
    data, random, solved = model.createData(), np.random.default_rng(0), 0
    low, high = model.lowerPositionLimit, model.upperPositionLimit
    for target in targets:
        for _ in range(20):
            q = random.uniform(low, high)
            for _ in range(40):
                pin.computeJointJacobians(model, data, q)
                error = target - data.oMi[joint].translation
                square = error @ error
                if square < 1e-20:
                    break
                J = pin.getJointJacobian(model, data, joint, WORLD)[:3]
                damped = J @ J.T + (0.1 * square + 1e-10) * np.eye(3)
                q = np.clip(q + J.T @ np.linalg.solve(damped, error), low, high)
            if square < 1e-20:
                solved += 1
                break
    return solved


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
    values, rounds = np.full(lanes, 0.5), 20_000_000
    return 2.0 * lanes * CHAINS * rounds / seconds(lambda: run(values.ctypes.data, rounds), 3)


def measure(robot: str, rows: int, loop_rows: int) -> dict[str, Any]:
    model = load_robot(robot).model
    q, _, _ = samples(model, rows)
    few = q[:loop_rows]
    loops = {
        "inertia": seconds(lambda: pinocchio_inertia(model, few, 6), 3) / len(few),
        "inertia, gradient": seconds(lambda: pinocchio_gradient(model, few, 6), 3) / len(few),
    }
    fastest = peak()
    cases: dict[str, dict[str, float]] = {}
    exact = build_kernel(model, [(6, ORIGIN)], ("inertia", "gradient"))(few, H)
    assert np.allclose(exact["inertia"][0], pinocchio_inertia(model, few, 6))
    assert np.allclose(exact["gradient"][0], pinocchio_gradient(model, few, 6))
    for name, (contacts, outputs) in CASES.items():
        case: dict[str, float] = {}
        for backend in ("llvm", "numpy"):
            kernel = build_kernel(model, contacts, outputs, backend)
            case[f"{backend}_build_s"] = seconds(
                lambda c=contacts, o=outputs, b=backend: build_kernel(model, c, o, b), 3
            )
            work = seconds(lambda k=kernel: k(q, H, 2.0, threads=1), 5 if backend == "llvm" else 2)
            case[f"{backend}_us"] = 1e6 * work / rows
            if name in loops:
                case[f"{backend}_speedup"] = loops[name] * rows / work
        kernel = build_kernel(model, contacts, outputs, "llvm")
        threaded = seconds(lambda k=kernel: k(q, H, 2.0), 5)
        case["threads"] = available_cpus()
        case["thread_speedup"] = case["llvm_us"] * 1e-6 * rows / threaded
        names = [operation.name for operation in kernel.runnable.program.operations]
        circular = names.count("sin") + names.count("cos")
        case["operations"] = len(names) + (SINE_OR_COSINE - 1) * circular
        case["peak_fraction"] = case["operations"] / (case["llvm_us"] * 1e-6) / fastest
        if name in loops:
            case["pinocchio_us"] = 1e6 * loops[name]
        cases[name] = case
    return {
        "robot": robot,
        "rows": rows,
        "peak_flop_per_s": fastest,
        "accuracy": accuracy(model),
        "cases": cases,
        "ik": measure_ik(model, q, loop_rows),
    }


def accuracy(model: pin.Model) -> dict[str, float]:
    """Largest relative deviations from Pinocchio over 1000 configurations."""
    q, h, _ = samples(model, 1000)
    found = build_kernel(model, [(6, ORIGIN)], ("inertia", "gradient"))(q, h)
    data = model.createData()
    worst = {"inertia": 0.0, "gradient": 0.0}
    for i in range(len(q)):
        reference = Reference.at(model, data, q[i], (6, ORIGIN), h[i])
        inertia = 1.0 / reference.mobility
        gradient = -(inertia**2) * reference.mobility_gradient
        deviation = np.abs(found["gradient"][0, i] - gradient).max()
        size = max(inertia, np.abs(gradient).max())
        worst["gradient"] = max(worst["gradient"], float(deviation / size))
        worst["inertia"] = max(worst["inertia"], abs(found["inertia"][0, i] / inertia - 1.0))
    return worst


def measure_ik(model: pin.Model, q: Any, loop_rows: int) -> dict[str, float]:
    position = build_kernel(model, [(6, ORIGIN)], ("position",))
    targets = np.ascontiguousarray(position(q, H)["position"][0])
    few = targets[: loop_rows // 10]
    place(model, (6, ORIGIN), few)
    start = time.perf_counter()
    found = place(model, (6, ORIGIN), targets, threads=1)
    spent = time.perf_counter() - start
    plain = seconds(
        lambda: place(model, (6, ORIGIN), targets[:20_000], threads=1, backend="numpy"), 1
    )
    loop = seconds(lambda: pinocchio_ik(model, few, 6), 1) / len(few)
    return {
        "pinocchio_solved": pinocchio_ik(model, few, 6) / len(few),
        "solved": float(found.solved.mean()),
        "llvm_us": 1e6 * spent / len(targets),
        "numpy_us": 1e6 * plain / min(20_000, len(targets)),
        "pinocchio_us": 1e6 * loop,
        "llvm_speedup": loop * len(targets) / spent,
    }


def show(result: dict[str, Any]) -> None:
    title = f"{result['robot']}, {result['rows']} configurations, us each (one thread)"
    table = Table(title=title)
    columns = "task", "Pinocchio loop", "NumPy", "LLVM", "NumPy x", "LLVM x", "threads x"
    for column in (*columns, "build (s)", "operations", "of peak"):
        table.add_column(column, justify="left" if column == "task" else "right")

    def cell(case: dict[str, float], key: str, form: str) -> str:
        return format(case[key], form) if key in case else ""

    keys = {"pinocchio_us": ".2f", "numpy_us": ".3f", "llvm_us": ".4f", "numpy_speedup": ".1f"}
    keys |= {"llvm_speedup": ".0f", "thread_speedup": ".2f", "llvm_build_s": ".3f"}
    keys |= {"operations": ".0f", "peak_fraction": ".0%"}
    for name, case in result["cases"].items():
        table.add_row(name, *(cell(case, key, form) for key, form in keys.items()))
    table.add_row("place joint 6", *(cell(result["ik"], key, form) for key, form in keys.items()))
    console = Console()
    console.print(table)
    deviation = ", ".join(f"{name} {value:.1e}" for name, value in result["accuracy"].items())
    console.print(f"largest relative deviation from Pinocchio: {deviation}")
    console.print(f"targets solved: {result['ik']['solved']:.6%}")
    console.print(f"one core: {result['peak_flop_per_s'] / 1e9:.1f} GFLOP/s in fused multiply-adds")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--robot", default="iiwa14")
    parser.add_argument("--rows", type=int, default=1_000_000)
    parser.add_argument("--loop-rows", type=int, default=3000, help="for the Pinocchio loops")
    parser.add_argument("--json", action="store_true", help="print one JSON object")
    options = parser.parse_args()
    result = measure(options.robot, options.rows, options.loop_rows)
    if options.json:
        print(json.dumps(result, indent=2))
    else:
        show(result)


if __name__ == "__main__":
    main()
