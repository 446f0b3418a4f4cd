"""The zeroth-order approximation (Altintas and Budak 1995): H replaced by its mean, det(1 + w (1 - 1 / mu) G(f) mean H) = 0."""
import cmath
import math

from monodromy import X, Y, compliance, cutting, engaged_rad

HZ_STEP = 0.25


class ZerothOrder:
    def __init__(self, milling):
        """The mean of H over a turn, by the midpoint rule."""
        self.milling = milling
        entry_rad, exit_rad = engaged_rad(milling)
        count, step_rad = 2000, (exit_rad - entry_rad) / 2000
        all_h = [cutting(milling, entry_rad + (at + 0.5) * step_rad) for at in range(count)]
        share = milling.teeth * step_rad / math.tau
        self.mean = [[share * sum(h[row][column] for h in all_h) for column in (X, Y)] for row in (X, Y)]
        self.all_hz = [HZ_STEP * at for at in range(1, int(2.5 * max(mode.hz for mode in milling.modes) / HZ_STEP))]
        self.all_values = [self.eigenvalues(hz) for hz in self.all_hz]

    def eigenvalues(self, hz):
        """Of -G mean H."""
        g = [compliance(self.milling.modes, axis, hz) for axis in (X, Y)]
        (a, b), (c, d) = [[-g[row] * value for value in self.mean[row]] for row in (X, Y)]
        root = cmath.sqrt((a - d) ** 2 / 4 + b * c)
        return [(a + d) / 2 + root, (a + d) / 2 - root]

    def lowest(self):
        """Of all speeds: depth and frequency. From w (1 - 1 / mu) = 1 / eigenvalue with |mu| = 1."""
        pairs = zip(self.all_hz, self.all_values)
        return min((0.5 / value.real, hz) for hz, values in pairs for value in values if value.real > 0.0)

    def at(self, tooth_s):
        """Depth and frequency at one speed: where an eigenvalue of -(1 - 1 / mu) G mean H becomes real."""

        def gains(hz, values, near):
            one, other = [(1.0 - cmath.exp(-1j * math.tau * hz * tooth_s)) * value for value in values]
            is_so = abs(one - near[0]) + abs(other - near[1]) <= abs(other - near[0]) + abs(one - near[1])
            return (one, other) if is_so else (other, one)

        found, before = [], (0j, 0j)
        for hz, values in zip(self.all_hz, self.all_values):
            now = gains(hz, values, before)
            for at in (0, 1):
                if (before[at].imag > 0.0) != (now[at].imag > 0.0):
                    found += root(lambda hz: gains(hz, self.eigenvalues(hz), now)[at], hz - HZ_STEP, hz)
            before = now
        return min(found)


def root(gain, low_hz, high_hz):
    """Where a gain becomes real, and the depth there."""
    is_above = gain(low_hz).imag > 0.0
    while high_hz - low_hz > 1e-7:
        middle_hz = (low_hz + high_hz) / 2
        if (gain(middle_hz).imag > 0.0) == is_above:
            low_hz = middle_hz
        else:
            high_hz = middle_hz
    # Infinitely deep where the vibration of one tooth meets that of the one before.
    real = gain(high_hz).real
    return [(1.0 / real, high_hz)] if real > 1e-9 else []
