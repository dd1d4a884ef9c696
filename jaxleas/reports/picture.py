"""A picture of a page: blank at first, its axes dressed alike, at last the bytes of a PNG."""

from dataclasses import dataclass
from io import BytesIO
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure


@dataclass(frozen=True)
class Picture:
    """A picture of a report.

    Attributes:
        name: name of the picture's file, without suffix.
        caption: caption of one or two sentences.
        png: bytes of the picture, as PNG.
    """

    name: str
    caption: str
    png: bytes


def blank_picture(width: float, height: float) -> "Figure":
    """Return a picture to draw on, of the given width and height [inches]."""
    from matplotlib.figure import Figure  # not pyplot: no global state, no window

    return Figure(figsize=(width, height), layout="constrained")


def dress(ax: "Axes") -> None:
    """Give axes a light grid, small numbers and no frame above and to the right."""
    ax.grid(color="0.9", linewidth=0.6)
    ax.tick_params(labelsize=8)
    ax.spines[["top", "right"]].set_visible(False)


def png_of(figure: "Figure", dpi: int) -> bytes:
    """Return a picture as PNG.

    Args:
        figure: picture that was drawn.
        dpi: resolution [pixels per inch].
    """
    stream = BytesIO()
    # Without the software's version in it, equal pixels give equal bytes.
    figure.savefig(stream, format="png", dpi=dpi, metadata={"Software": None})
    return stream.getvalue()
