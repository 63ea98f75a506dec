"""A row of the comparison: what the paper prints, what comes out on each arm, and why."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from typing import Any

from hitjoints.evidence.paper.variants import VARIANTS

Value = float | int | str | None
Values = Mapping[str, Value]


@dataclass(frozen=True)
class ClaimRow:
    """One quantity.

    Attributes:
        figure: where the paper has it: "fig2", "fig4", "fig5", "fig6", "text", or "spread".
        quantity: what it is, with its unit.
        paper: a number or words, as printed; None where the paper prints none.
        iiwa14_bullet: what comes out on each arm.
        iiwa14: what comes out on each arm.
        iiwa14_phantom: what comes out on each arm.
        remark: what differs, and why.
    """

    figure: str
    quantity: str
    paper: Value
    iiwa14_bullet: Value
    iiwa14: Value
    iiwa14_phantom: Value
    remark: str

    def as_dict(self) -> dict[str, Any]:
        """Return the attributes by name."""
        return asdict(self)


@dataclass(frozen=True)
class Item:
    """A row before it is computed.

    Attributes:
        key: of the value.
        figure: as of a `ClaimRow`.
        quantity: as of a `ClaimRow`.
        paper: as of a `ClaimRow`.
        remark: text in which {bullet[key]}, {iiwa14[key]} and {phantom[key]} stand for values, and
            {tensors[key]} for what PyBullet's tensors add to the URDF's, %.
    """

    key: str
    figure: str
    quantity: str
    paper: Value
    remark: str = ""


def rows_of(lines: Sequence[Item], values: Mapping[str, Values]) -> list[ClaimRow]:
    """Return the rows of some lines, from the values of every variant by their keys."""
    names = {name.removeprefix("iiwa14_"): values[name] for name in VARIANTS}
    names["tensors"] = {
        key: 100 * (value / clean - 1)
        for key, value in names["bullet"].items()
        if isinstance(value, float) and isinstance(clean := names["iiwa14"][key], float) and clean
    }
    return [
        ClaimRow(
            line.figure,
            line.quantity,
            line.paper,
            values["iiwa14_bullet"][line.key],
            values["iiwa14"][line.key],
            values["iiwa14_phantom"][line.key],
            line.remark.format(**names),
        )
        for line in lines
    ]
