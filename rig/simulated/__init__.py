"""The simulated rig: amplifiers on a bus, a camera that sees the plate, a platform that moves.

`open_rig` is its entry point (group ``cdpr8.rigs``, name ``simulated``).
"""

from rig.simulated.rig import assemble, open_rig

__all__ = ["assemble", "open_rig"]
