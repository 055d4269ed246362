"""Finding left-out physics in anything that can be simulated (design, section 6).

The engine knows nothing of cables. It is given a `System`: recorded channels with their times and
noise, a simulator, parameters with how well they are known, and candidates for what the simulator
may have left out. It finds out which of these the recording asks for, if any.
"""

from analysis.engine.bundle import Bundle, Segment
from analysis.engine.candidate import Candidate, Setting, Shape, Term
from analysis.engine.diagnosis import Diagnosis, diagnose
from analysis.engine.hypothesis import Hypothesis
from analysis.engine.system import Nuisance, Point, System

__all__ = [
    "Bundle",
    "Candidate",
    "Diagnosis",
    "Hypothesis",
    "Nuisance",
    "Point",
    "Segment",
    "Setting",
    "Shape",
    "System",
    "Term",
    "diagnose",
]
