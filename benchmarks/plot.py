"""The contests as a picture: how many times faster than each peer, or slower."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from benchmarks.harness import Row
from benchmarks.report import Result
from hitjoints.show.style import COLOURS

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

FASTER, SLOWER = COLOURS[1], COLOURS[0]
LINE = 0.2  # inches per bar or heading


def draw(rows: Sequence[Result]) -> Figure:
    """Return bars of the contests' ratios, grouped by task, in two columns."""
    from matplotlib.figure import Figure
    from matplotlib.patches import Patch

    tasks: dict[str, list[Row]] = {}
    for row in rows:
        if isinstance(row, Row) and row.contest:
            tasks.setdefault(row.what, []).append(row)
    columns = _halves(tasks)
    height = max((_lines(column) for column in columns), default=0)
    figure = Figure(figsize=(13, 1.2 + LINE * height), layout="constrained")
    ratios = [bound for each in tasks.values() for row in each for bound in (row.low, row.high)]
    for axis, column in zip(figure.subplots(1, 2), columns, strict=True):
        _draw_column(axis, column, height)
        axis.set_xscale("log")
        axis.set_xlim(min([0.1, *ratios]) / 25, max([10, *ratios]) * 12)
    figure.legend(
        handles=[Patch(color=FASTER), Patch(color=SLOWER)],
        labels=["hitjoints is faster", "the peer is faster"],
        loc="outside upper center",
        ncols=2,
        frameon=False,
    )
    return figure


def _halves(tasks: dict[str, list[Row]]) -> tuple[dict[str, list[Row]], dict[str, list[Row]]]:
    """Split the tasks, in order, where the two columns are most alike in length."""
    names = list(tasks)

    def split(i: int) -> tuple[dict[str, list[Row]], dict[str, list[Row]]]:
        return {n: tasks[n] for n in names[:i]}, {n: tasks[n] for n in names[i:]}

    return min(map(split, range(len(names) + 1)), key=lambda halves: max(map(_lines, halves)))


def _lines(tasks: dict[str, list[Row]]) -> int:
    return sum(len(rows) + 2 for rows in tasks.values())  # a heading and a gap


def _draw_column(axis: Axes, tasks: dict[str, list[Row]], height: int) -> None:
    labels: dict[float, str] = {}
    headings = []
    y = 0.0
    for what, rows in tasks.items():
        headings.append(len(labels))
        labels[y] = what
        for row in rows:
            y += 1
            labels[y] = _peer(row)
            _draw_bar(axis, y, row)
        y += 2
    axis.axvline(1, color="black", lw=0.8)
    axis.set_yticks(list(labels), list(labels.values()), fontsize="small")
    for i in headings:
        axis.get_yticklabels()[i].set_fontweight("bold")
    axis.set_ylim(height - 0.5, -1)
    axis.tick_params(axis="y", length=0)
    axis.grid(axis="x", color="0.9")
    axis.set_axisbelow(True)
    axis.set_xlabel("peer's time / ours (line: extremes)", fontsize="small")
    axis.spines[["top", "right", "left"]].set_visible(False)


def _draw_bar(axis: Axes, y: float, row: Row) -> None:
    faster = row.ratio >= 1
    axis.barh(y, row.ratio - 1, left=1, height=0.7, color=FASTER if faster else SLOWER)
    axis.plot([row.low, row.high], [y, y], color="black", lw=1)
    end = max(row.ratio, row.high) if faster else min(row.ratio, row.low)
    axis.annotate(
        f"{row.ratio:,.0f}" if row.ratio >= 100 else f"{row.ratio:.2g}",
        (end, y),
        xytext=(4 if faster else -4, 0),
        textcoords="offset points",
        ha="left" if faster else "right",
        va="center",
        fontsize="x-small",
    )


def _peer(row: Row) -> str:
    """Return the peer's name; with ours where several of ours meet it."""
    ours = row.ours.split(",")[0]
    return f"{row.peer} ({ours})" if ours in ("numpy", "llvm") else row.peer
