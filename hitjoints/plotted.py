"""Results that can be drawn: `plot` asks the package for `figures`, so that none imports them."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, ClassVar

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure


class Plotted:
    """A result that `hj.figures` has a function for.

    Attributes:
        drawn_by: name of that function.
    """

    drawn_by: ClassVar[str]

    def plot(self, ax: Axes | None = None, **options: Any) -> Figure:
        """Draw the result as `hj.figures` does.

        Args:
            ax: draw its main panel there. By default the whole figure, of its own, which a
                notebook shows and `savefig` writes.
            options: of that function: size, font and style.

        Returns:
            The figure that was drawn on.

        Raises:
            InputError: an option cannot be used.
        """
        import hitjoints

        figure: Figure = getattr(hitjoints.figures, self.drawn_by)(self, ax=ax, **options)
        return figure
