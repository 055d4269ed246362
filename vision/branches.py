"""Which of two poses, over a whole sequence.

Seen face-on, one frame may not tell a plane's pose from its mirror image; many frames together do,
because the true branch fits a little better in each and moves without jumps. The cheapest path
through the candidates of all frames (Viterbi) counts both, so a wrong branch taken early is left
again, and the cost of the cheapest path through the other branch says how sure that is.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from vision.pose import DECISIVE, MISFIT, CameraPose, PoseEstimate, angle_of

Array = NDArray[np.float64]

USUAL_TURN_RAD = np.deg2rad(2.0)
"""Turn between frames that costs a unit of chi-squared: 2 deg at 2.06 Hz turns 1.6 deg a frame."""

DEAREST_TURN = 40.0
"""No turn costs more: what frames show in the end overrules how it moves."""

STRONGEST_FRAME = 40.0
"""No frame counts for more than this: errors shared by all frames are not noise."""


def turn_cost(a: CameraPose, b: CameraPose, frames: int) -> float:
    """Chi-squared of turning from one pose to another within so many frames."""
    turn = angle_of(a.rotation, b.rotation) / float(USUAL_TURN_RAD * frames)
    return min(turn * turn, DEAREST_TURN)


class BranchScore:
    """The running score of both branches: what a live tracker knows of the frames so far."""

    def __init__(self) -> None:
        self._poses: list[CameraPose] = []
        self._costs: list[float] = []

    def take(self, estimate: PoseEstimate, frames: int) -> PoseEstimate:
        """Add a frame, so many after the last, and choose its branch.

        Parameters
        ----------
        estimate
            The poses of this frame.
        frames
            Since the last one with a pose; over one after frames without.
        """
        poses = _candidates(estimate)
        costs = _own_costs(estimate)
        if self._poses:
            costs = [
                own + min(c + turn_cost(p, pose, frames) for p, c in self._known())
                for pose, own in zip(poses, costs, strict=True)
            ]
        least = min(costs)
        self._poses, self._costs = poses, [cost - least for cost in costs]
        return _chosen(estimate, self._costs)

    def _known(self) -> list[tuple[CameraPose, float]]:
        return list(zip(self._poses, self._costs, strict=True))

    def forget(self) -> None:
        """Start anew."""
        self._poses, self._costs = [], []


def choose_branches(frames: Sequence[int], estimates: Sequence[PoseEstimate]) -> list[PoseEstimate]:
    """Choose the branch of every frame with the knowledge of all.

    Parameters
    ----------
    frames
        Numbers of the frames, ascending.
    estimates
        Their poses.
    """
    poses = [_candidates(one) for one in estimates]
    own = [_own_costs(one) for one in estimates]
    steps = np.maximum(np.diff(frames), 1)
    forward, backward = [list(own[0])] if own else [], [[0.0] * len(own[-1])] if own else []
    for k in range(1, len(own)):
        forward.append(_passed(poses[k - 1], forward[-1], poses[k], int(steps[k - 1]), own[k]))
    for k in range(len(own) - 2, -1, -1):
        ahead = [own[k + 1][i] + backward[-1][i] for i in range(len(own[k + 1]))]
        nothing = [0.0] * len(poses[k])
        backward.append(_passed(poses[k + 1], ahead, poses[k], int(steps[k]), nothing))
    backward.reverse()
    return [
        _chosen(one, [f + b for f, b in zip(fs, bs, strict=True)])
        for one, fs, bs in zip(estimates, forward, backward, strict=True)
    ]


def _passed(
    before: list[CameraPose],
    costs: list[float],
    poses: list[CameraPose],
    frames: int,
    own: list[float],
) -> list[float]:
    return [
        own_cost
        + min(cost + turn_cost(p, pose, frames) for p, cost in zip(before, costs, strict=True))
        for pose, own_cost in zip(poses, own, strict=True)
    ]


def _candidates(estimate: PoseEstimate) -> list[CameraPose]:
    worse = estimate.worse
    return [estimate.better] if worse is None else [estimate.better, worse]


def _own_costs(estimate: PoseEstimate) -> list[float]:
    return [0.0] if estimate.worse is None else [0.0, min(estimate.lead, STRONGEST_FRAME)]


def _chosen(estimate: PoseEstimate, costs: list[float]) -> PoseEstimate:
    """The estimate on the cheaper branch; doubt that other frames remove is no doubt."""
    worse = estimate.worse
    if worse is None:
        return estimate
    swap = costs[1] < costs[0]
    sure = abs(costs[1] - costs[0]) >= DECISIVE and estimate.misfit < MISFIT
    return replace(
        estimate,
        pose=worse if swap else estimate.better,
        rival=estimate.better if swap else worse,
        from_previous=swap,
        ambiguous=estimate.lead < DECISIVE and not sure,
    )
