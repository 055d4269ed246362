"""The ground floor of the CDPR-8 experiment toolkit: what every other package stands on.

Rig files (`cdpr8.rigfile`), run folders (`cdpr8.runfolder`), clocks, errors and the terminal.

Units, everywhere: seconds, metres, newtons and radians inside; degrees at the edges (files,
tables, terminal), where the name carries the unit (``pitch_deg``). Cables are numbered 1 to 8;
arrays hold cable ``i`` at index ``i - 1``. The frame O-XYZ has its origin at the rest position of
the platform's centre of mass: X forward, Y left, Z up; pitch is rotation about Y.
"""

CABLES = 8
"""Number of cables of the machines this toolkit describes."""

STANDARD_GRAVITY_M_PER_S2 = 9.80665
"""Standard acceleration of free fall (ISO 80000-3), along -Z."""
