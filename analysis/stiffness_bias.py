"""What follows the rate of elongation, not the elongation: friction, damping or timing."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from analysis.steady import LEAST_SAMPLES, Steady, harmonic_basis, noise_level

Array = NDArray[np.float64]

SEEN = 4.0
"""What stands out of its sigma by this is there."""

ALIKE = 3.0
"""Lags of several cables that differ by less than this, reduced chi2, are one."""

NEAR = (0.4, 2.5)
"""Friction by its third harmonic and by its first agree to within these factors."""

RATES_APART = 1.5
"""Runs whose rates differ by less than this tell nothing of how the quadrature depends on rate."""


@dataclass(frozen=True)
class Bias:
    """One cable.

    Attributes
    ----------
    quadrature_n, quadrature_sigma_n
        Amplitude of the tension in phase with the rate of elongation, in the first run, N.
    friction_n, friction_sigma_n
        Coulomb friction that the third harmonic asks for, N: F sgn(v) has one of 4 F / (3 pi).
    rubs
        Whether first and third harmonic agree on friction.
    lag_s, lag_sigma_s
        By how much the tension leads the elongation, s.
    share
        By how much, at most, the stiffness could be off for this, as a share of itself.
    constant_n, viscous_n_s_per_m
        From runs of several rates: quadrature = 4/pi constant + viscous times rate amplitude.
        None: the runs do not tell.
    """

    quadrature_n: float
    quadrature_sigma_n: float
    friction_n: float
    friction_sigma_n: float
    rubs: bool
    lag_s: float
    lag_sigma_s: float
    share: float
    constant_n: float | None = None
    viscous_n_s_per_m: float | None = None


@dataclass(frozen=True)
class Biases:
    """All cables, shape 8; and the lag they have in common."""

    cables: tuple[Bias, ...]
    lag_s: float
    lag_sigma_s: float
    one_lag: bool
    hertz: float

    def sentences(self, told: Sequence[int]) -> list[str]:
        """What a reader must know, of the cables that moved enough."""
        found = []
        rubbing = [c for c in told if self.cables[c - 1].rubs]
        if rubbing:
            worst = max(self.cables[c - 1].share for c in rubbing)
            force = max(self.cables[c - 1].friction_n for c in rubbing)
            found.append(
                f"cable {', '.join(map(str, rubbing))}: friction, up to {force:.2g} N: a part of "
                "the tension turns with the direction of motion and has its third harmonic. Where "
                f"it builds up over some travel it reads as stiffness, by up to {100 * worst:.1f} %"
            )
        if abs(self.lag_s) > SEEN * self.lag_sigma_s and self.one_lag:
            share = 1.0 - np.cos(2.0 * np.pi * self.hertz * self.lag_s)
            found.append(
                f"all tensions {'lead' if self.lag_s > 0.0 else 'lag'} the elongation by "
                f"{1e3 * abs(self.lag_s):.1f} ms alike: clocks (camera latency, cell lag) or "
                f"damping of the cables, not told apart. If it is timing, stiffnesses read low by "
                f"{100.0 * share:.2g} %"
            )
        else:
            quadrature = [
                c
                for c in told
                if c not in rubbing
                and abs(self.cables[c - 1].quadrature_n)
                > SEEN * self.cables[c - 1].quadrature_sigma_n
            ]
            if quadrature:
                found.append(
                    f"cable {', '.join(map(str, quadrature))}: a part of the tension follows the "
                    "rate of elongation: damping or friction of these cables, or their cells' lag"
                )
        constant = [c for c in told if self.cables[c - 1].constant_n is not None]
        for c in constant:
            one = self.cables[c - 1]
            found.append(
                f"cable {c}: over the runs' rates the quadrature is {one.constant_n:.2g} N "
                f"whatever the rate (friction) and {one.viscous_n_s_per_m:.2g} N s/m in proportion "
                "to it (damping or timing)"
            )
        return found


def biases(parts: Sequence[Steady], slopes: Sequence[Array]) -> Biases:
    """What follows the rate, in runs of one machine.

    Parameters
    ----------
    parts
        The runs' steady motion.
    slopes
        Stiffness of each cable in each run, shape (8,), N/m.
    """
    looked = [_look(part, slope) for part, slope in zip(parts, slopes, strict=True)]
    first, slope = parts[0], slopes[0]
    lag, lag_sigma = _common(parts, looked, slopes)
    cables = []
    for i in range(8):
        quadrature, sigma, third, third_sigma = looked[0][i]
        friction = 0.75 * np.pi * third
        by_first = 0.25 * np.pi * quadrature
        rubs = bool(
            third > SEEN * third_sigma
            and quadrature > SEEN * sigma
            and NEAR[0] < by_first / max(friction, 1e-12) < NEAR[1]
        )
        stiff = slope[i] * first.moved_m[i]
        constant, viscous = _by_rate(parts, looked, i)
        cables.append(
            Bias(
                quadrature_n=quadrature,
                quadrature_sigma_n=sigma,
                friction_n=max(friction, 0.0),
                friction_sigma_n=0.75 * np.pi * third_sigma,
                rubs=rubs,
                lag_s=quadrature / (stiff * first.circular),
                lag_sigma_s=sigma / (abs(stiff) * first.circular),
                share=friction / stiff if rubs else 0.5 * (quadrature / stiff) ** 2,
                constant_n=constant,
                viscous_n_s_per_m=viscous,
            )
        )
    return Biases(tuple(cables), lag[0], lag_sigma, lag[1], first.hertz)


def _look(part: Steady, slope: Array) -> list[tuple[float, float, float, float]]:
    """For each cable quadrature, its sigma, third harmonic as friction has it, its sigma; N."""
    found = []
    for i in range(8):
        t_s, tension = part.tension_t_s[i], part.tension_n[i]
        if len(t_s) <= LEAST_SAMPLES or not np.isfinite(slope[i]):
            found.append((0.0, np.inf, 0.0, np.inf))
            continue
        columns = part.columns(t_s, part.machine.base[i], part.machine.anchor[i])
        factors = np.linalg.lstsq(columns, tension, rcond=None)[0]
        rest = tension - columns @ factors
        moved = part.moved_m[i]
        # The elongation is moved * cos(angle - phase): its rate is -sin, and sgn of that has a
        # third harmonic of a third, -sin(3 (angle - phase)) / 3.
        own = np.linalg.lstsq(harmonic_basis(t_s, part.hertz, 1), columns[:, 2], rcond=None)[0]
        phase = np.arctan2(own[2], own[1])
        third = harmonic_basis(t_s, 3.0 * part.hertz, 1)
        amplitudes = np.linalg.lstsq(third, rest, rcond=None)[0]
        sine = amplitudes[2] * np.cos(3.0 * phase) - amplitudes[1] * np.sin(3.0 * phase)
        rest = rest - third @ amplitudes
        level = noise_level(t_s, rest, 3.0 * part.hertz)
        found.append(
            (
                float(factors[3] * moved),
                float(np.hypot(part.tension_noise_n[i], slope[i] * part.pose_noise_m[i])),
                float(-sine),
                float(np.sqrt(2.0 * level / len(t_s))),
            )
        )
    return found


def _common(
    parts: Sequence[Steady],
    looked: Sequence[Sequence[tuple[float, float, float, float]]],
    slopes: Sequence[Array],
) -> tuple[tuple[float, bool], float]:
    """The lag of all cables in all runs, whether it is one, and its sigma."""
    found, errors = [], []
    for part, looks, slope in zip(parts, looked, slopes, strict=True):
        for i, (quadrature, error, _, _) in enumerate(looks):
            stiff = float(slope[i] * part.moved_m[i] * part.circular)
            if np.isfinite(error) and stiff > 0.0:
                found.append(quadrature / stiff)
                errors.append(error / stiff)
    lag, sigma = np.array(found), np.array(errors)
    weight = sigma**-2
    mean = float(weight @ lag / weight.sum())
    # Even one lag is not quite one: samples are in time to some tenths of a millisecond.
    chi2 = float((((lag - mean) ** 2) / (sigma**2 + (0.1 * mean) ** 2)).sum())
    return (mean, chi2 < ALIKE * max(len(lag) - 1, 1)), float(weight.sum() ** -0.5)


def _by_rate(
    parts: Sequence[Steady], looked: Sequence[Sequence[tuple[float, float, float, float]]], i: int
) -> tuple[float | None, float | None]:
    """Quadrature of a cable as friction and as damping, where the runs' rates differ."""
    rates = np.array([part.moved_m[i] * part.circular for part in parts])
    if len(parts) < 2 or rates.max() < RATES_APART * rates.min():
        return None, None
    force = np.array([looks[i][0] for looks in looked])
    sigma = np.array([looks[i][1] for looks in looked])
    if not np.isfinite(sigma).all():
        return None, None
    columns = np.column_stack([np.full(len(rates), 4.0 / np.pi), rates]) / sigma[:, None]
    factors = np.linalg.lstsq(columns, force / sigma, rcond=None)[0]
    spread = np.sqrt(np.diag(np.linalg.inv(columns.T @ columns)))
    if (np.abs(factors) < SEEN * spread).all():
        return None, None
    return float(factors[0]), float(factors[1])
