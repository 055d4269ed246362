"""The frame: four posts that give way to their cables, each a mass on a spring with a damper."""

import numpy as np
from numpy.typing import NDArray

from analysis.challenge.outsider import layout as at_
from analysis.challenge.outsider.compiled import law
from analysis.challenge.outsider.vectors import Vector, at, gained, minus, plus, times

Array = NDArray[np.float64]

POST_STATES = 6
POSTS = 4


@law
def post_at(cable: Array) -> int:
    """Where the displacement of a cable's post stands in the state."""
    return at_.FRAME + POST_STATES * int(cable[at_.POST])


@law
def pull_post(change: Array, cable: Array, platform: Array, rest: Vector, force: Vector) -> None:
    """What a cable's pull, less that at rest, does to its post: `frame_compliance`.

    Parameters
    ----------
    change
        Shape (STATES,).
    cable, platform
        Their numbers.
    rest
        Direction from anchor to base at rest.
    force
        Of the cable on the platform, N.
    """
    more = minus(times(cable[at_.PRETENSION], rest), force)
    gained(change, post_at(cable) + 3, times(1.0 / platform[at_.POST_MASS], more))


@law
def swing_posts(state: Array, change: Array, platform: Array) -> None:
    """Springs and dampers of the posts, in three directions alike."""
    for post in range(POSTS):
        here = at_.FRAME + POST_STATES * post
        speed = at(state, here + 3)
        back = times(-platform[at_.POST_STIFFNESS], at(state, here))
        slowed = times(-platform[at_.POST_LOSS], speed)
        gained(change, here, speed)
        gained(change, here + 3, times(1.0 / platform[at_.POST_MASS], plus(back, slowed)))
