"""What an exposure does to a motion: it averages it.

A sine of frequency f, seen with an exposure T, comes out smaller by sinc(f T) = sin(pi f T) /
(pi f T) and, with stamps at mid-exposure, without delay. The amplitude is corrected with that; the
samples are not, because each frequency has its own factor.
"""

import math

from cdpr8.errors import UsageError


def exposure_attenuation(frequency_hz: float, exposure_s: float) -> float:
    """Amplitude seen over true amplitude.

    Parameters
    ----------
    frequency_hz
        Of the motion.
    exposure_s
        How long the shutter is open.

    Returns
    -------
    float
        sinc(f T): 1 for a short exposure, 0 where it spans a whole period.

    Raises
    ------
    UsageError
        A negative frequency or exposure.
    """
    if frequency_hz < 0.0 or exposure_s < 0.0:
        raise UsageError(
            f"frequency {frequency_hz:g} Hz, exposure {exposure_s:g} s",
            allowed="both at least 0",
        )
    phase = math.pi * frequency_hz * exposure_s
    return math.sin(phase) / phase if phase > 1e-9 else 1.0


def corrected_amplitude(amplitude: float, frequency_hz: float, exposure_s: float) -> float:
    """The amplitude before the exposure averaged it, in the unit given.

    Parameters
    ----------
    amplitude
        As fitted to the samples.
    frequency_hz
        Of the motion.
    exposure_s
        How long the shutter was open.

    Raises
    ------
    UsageError
        The exposure spans most of a period or more: nothing is left to correct.
    """
    factor = exposure_attenuation(frequency_hz, exposure_s)
    if factor < 0.2:
        raise UsageError(
            f"an exposure of {exposure_s:g} s leaves {factor:.2f} of a motion at "
            f"{frequency_hz:g} Hz",
            allowed="an exposure below four fifths of the period",
            remedy="expose for a shorter time",
        )
    return amplitude / factor
