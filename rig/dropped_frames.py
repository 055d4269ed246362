"""Frames that a camera lost, told from the times of those that came."""


class DropCounter:
    """Frames lost before each, from the frames' times.

    Parameters
    ----------
    fps
        Nominal; the camera's own rate is followed, within `MOST_RATE_ERROR`.
    """

    def __init__(self, fps: float) -> None:
        self._nominal_s = self._period_s = 1.0 / fps
        self._due_s: float | None = None

    def before(self, t_s: float) -> int:
        """How many frames are missing before the one at `t_s`."""
        due_s = self._due_s
        if due_s is None:
            self._due_s = t_s + self._period_s
            return 0
        # Against the time it was due, not against the last one: which may have come late itself.
        late = (t_s - due_s) / self._period_s
        dropped = max(0, round(late))
        off_s = t_s - (due_s + dropped * self._period_s)
        self._due_s = t_s - (1.0 - FOLLOW) * off_s + self._period_s
        if dropped == 0:
            step_s = FOLLOW**2 * off_s
            low_s = self._nominal_s / (1.0 + MOST_RATE_ERROR)
            high_s = self._nominal_s * (1.0 + MOST_RATE_ERROR)
            self._period_s = min(high_s, max(low_s, self._period_s + step_s))
        return dropped


FOLLOW = 0.2
"""How much of a frame's lateness is taken for the camera's own rhythm."""

MOST_RATE_ERROR = 0.05
"""A camera slower than this against its rate loses frames, as far as a run is concerned."""
