"""How smoothly the tool goes: the spectral arc length of its speed."""

from collections.abc import Sequence

import numpy as np

CUT = 10.0
"""Hz: above it, nothing counts."""
LEAST = 0.05
"""Of the spectrum's value at 0 Hz; what is smaller behind the last larger one does not count."""
PADDING = 4


def spectral_arc_length(speeds: Sequence[float], rate_hz: float) -> float | None:
    """SPARC of a speed profile: 0 and less, the nearer to 0 the smoother; None where nothing moved.

    S. Balasubramanian, A. Melendez-Calderon, A. Roby-Brami, E. Burdet, "On the analysis of movement smoothness",
    J. NeuroEngineering and Rehabilitation 12:112, 2015: the length of the curve of the speed's normalised amplitude
    spectrum over frequency, with the cut-off that the amplitude decides, at most 10 Hz.

    Args:
        speeds: sampled evenly (m/s).
        rate_hz: of the samples.
    """
    profile = np.asarray(speeds, dtype=float)
    if len(profile) < 4 or profile.max() <= 0.0:
        return None
    count = 2 ** (int(np.ceil(np.log2(len(profile)))) + PADDING)
    frequencies = np.fft.rfftfreq(count, 1.0 / rate_hz)
    spectrum = np.abs(np.fft.rfft(profile, count))
    spectrum = spectrum[frequencies <= CUT] / spectrum.max()
    frequencies = frequencies[frequencies <= CUT]
    last = int(np.flatnonzero(spectrum >= LEAST)[-1]) + 1
    f, a = frequencies[:last], spectrum[:last]
    if len(f) < 2:
        return 0.0
    return -float(np.sum(np.hypot(np.diff(f) / (f[-1] - f[0]), np.diff(a))))
