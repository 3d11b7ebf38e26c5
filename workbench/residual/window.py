"""A window of a coordinate, or moments, in which a residual may be concentrated: one type, however it was sought."""

from dataclasses import dataclass

import numpy as np

EITHER, FORWARD, BACKWARD = 0, 1, -1
DIRECTIONS = {EITHER: "either direction", FORWARD: "forward", BACKWARD: "backward"}
LOCAL = 0.55  # share of the excess in a window, less the share of samples, from which the residual lives there
CONTRAST = 2.0  # rms inside over rms outside
STANDS_OUT = 1.5  # times the rms elsewhere from which a window is named
LEAST = 0.05  # of the residual's power that a window must hold to be named


@dataclass(frozen=True, eq=False)
class Window:
    """coordinate: "position", "velocity" (spans of its magnitude), "time", ... spans: (low, high), SI.

    direction: 1 forward, -1 backward, 0 either. share: of the power inside; where a floor is known, of the power above it.
    covered: share of the samples inside. inside, outside: rms of the residual over the floor's; where none is known, over
    the rms outside. unit: of the coordinate. record: the only one that it is in, "" for all. rows: (N,) of bool, the rows of
    a problem inside.
    """

    coordinate: str
    spans: tuple[tuple[float, float], ...]
    direction: int
    share: float
    covered: float
    inside: float
    outside: float
    unit: str = ""
    record: str = ""
    rows: np.ndarray | None = None

    @property
    def low(self) -> float:
        return min(low for low, _ in self.spans)

    @property
    def high(self) -> float:
        return max(high for _, high in self.spans)

    @property
    def times(self) -> float:
        """Rms inside over rms outside."""
        return self.inside / self.outside

    @property
    def contrast(self) -> float:
        """By how much its share of the power is more than its share of the samples."""
        return self.share - self.covered

    @property
    def stands_out(self) -> bool:
        """Whether the residual is plainly larger inside than elsewhere, and not a trifle of it."""
        return self.times >= STANDS_OUT and self.share >= LEAST


def local(window: Window | None) -> bool:
    """Whether a residual lives in a window: most of the excess, few of the samples, and little outside."""
    return window is not None and window.contrast > LOCAL and window.inside > CONTRAST * window.outside
