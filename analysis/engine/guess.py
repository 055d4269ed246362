"""A guess: a hypothesis from where it is to be led to the ring's phase."""

from dataclasses import dataclass

from analysis.engine.array import Array
from analysis.engine.fitted import Fitted
from analysis.engine.hypothesis import Hypothesis
from analysis.engine.state import State


@dataclass(frozen=True)
class Guess:
    """A hypothesis from where it is to be led to the ring's phase.

    Attributes
    ----------
    state
        The free numbers of what is on.
    nuisance
        In sigmas, shape (p,).
    log_score
        Of what told it, lines or the ring.
    """

    state: State
    nuisance: Array
    log_score: float = 0.0

    @classmethod
    def of(cls, fitted: Fitted) -> "Guess":
        """From where a fitted hypothesis stands."""
        return cls(fitted.state, fitted.point.nuisance, fitted.log_score)

    @property
    def hypothesis(self) -> Hypothesis:
        """With the shapes of its numbers."""
        return self.state.hypothesis
