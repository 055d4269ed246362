"""The stretches of a run: rest, onset, steady motion, stop and what follows."""

from analysis.engine.bundle import Segment
from cdpr8.rigfile.excitation import Excitation

LINES_HZ = 25.0
"""Of stretches that do not repeat, lines up to here."""

HELD_SHARE = 0.3
"""Of the steady cycles, kept back."""

LEAST_PERIODS = 6
"""Fewer steady periods than this are not split."""

CLEAR_S = 0.006
"""A motion starts with a jump: what a sample this near it shows is a matter of its instant, and of
how two rows of a simulation are joined."""


def segments(
    excitation: Excitation, shift_s: float, first_s: float, last_s: float
) -> tuple[Segment, ...]:
    """Rest, onset, steady motion (used and kept back), stop and what follows.

    Of a platform that is let go and not driven: rest and free decay.
    """
    if excitation.rests:
        return (Segment(first_s, last_s + 1e-9, None, LINES_HZ, name="whole"),)
    start, end = excitation.start_s + shift_s, excitation.end_s + shift_s
    found: list[Segment] = []

    def free(a: float, b: float, name: str) -> None:
        a, b = max(a, first_s), min(b, last_s + 1e-9)
        if b - a > 0.05:
            found.append(Segment(a, b, None, LINES_HZ, name=name))

    free(first_s, start - CLEAR_S, "rest")
    if excitation.amplitude_deg == 0.0:
        free(start + CLEAR_S, last_s + 1.0, "free decay")
        return tuple(found)
    first, last = (one + shift_s for one in excitation.steady_window_s)
    steady = (first, min(last, last_s + 1e-9))
    free(start + CLEAR_S, steady[0], "onset")
    frequency = excitation.frequency_hz
    periods = int((steady[1] - steady[0]) * frequency + 1e-6)
    if periods >= LEAST_PERIODS:
        middle = steady[0] + round(periods * (1.0 - HELD_SHARE)) / frequency
        found.append(Segment(steady[0], middle, frequency, name="steady"))
        found.append(Segment(middle, steady[1], frequency, held_out=True, name="steady, held out"))
    elif periods >= 2:
        found.append(Segment(*steady, frequency, name="steady"))
    else:
        free(*steady, "steady")
    free(steady[1], end, "stop")
    free(end, last_s + 1.0, "after")
    return tuple(found)
