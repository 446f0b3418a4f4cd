"""What becomes of a vibration from tooth to tooth in linear regenerative milling, by collocation of the monodromy operator.

Straight teeth on circles, one in the cut at a time, x along the feed, angles phi clockwise from +y:

    M q'' + C q' + K q = F(t),  F = -w H(phi) (q(t) - q(t - T)),  T the time from tooth to tooth
    H = [[s (Kt c + Kn s), c (Kt c + Kn s)], [s (-Kt s + Kn c), c (-Kt s + Kn c)]] in the cut, s = sin phi, c = cos phi

(Altintas and Budak 1995; Insperger and Stepan 2004). A cut is taken in pieces no longer than a wave of the fastest mode. In each
the force is a polynomial through Chebyshev points and the modes answer it exactly (Duhamel's integral): q at these points follows
from q there one tooth before and from the state the piece begins with. Free flight is exact. mm, N, s.
"""
import cmath
import math
from collections import namedtuple

from eigenvalues import dot, eigenvalues, hessenberg

Mode = namedtuple("Mode", "hz damping n_per_mm axis")
Milling = namedtuple("Milling", "modes teeth kt_mpa kn_mpa immersion is_up")

X, Y = 0, 1
POINTS = 12
# For integrals of a mode's answer over a piece: a wave and a polynomial, to the last digits.
QUADRATURE = 40
KRYLOV = 40
# After so many teeth at the boundary nothing but the vibration that stays is left.
SETTLED_TEETH = 300


def engaged_rad(milling):
    edge_rad = math.acos(1.0 - 2.0 * milling.immersion)
    return (0.0, edge_rad) if milling.is_up else (math.pi - edge_rad, math.pi)


def cutting(milling, phi_rad):
    """H of a tooth in the cut, N/mm^2."""
    s, c = math.sin(phi_rad), math.cos(phi_rad)
    along, across = milling.kt_mpa * c + milling.kn_mpa * s, -milling.kt_mpa * s + milling.kn_mpa * c
    return [[s * along, c * along], [s * across, c * across]]


def chebyshev(count):
    """Points of (0, 1) and their weights (Fejer's first rule)."""
    angles = [(at + 0.5) * math.pi / count for at in range(count)]

    def weight(angle):
        terms = (math.cos(2 * k * angle) / (4 * k * k - 1) for k in range(1, count // 2 + 1))
        return (1.0 - 2.0 * sum(terms)) / count

    return [(0.5 - 0.5 * math.cos(angle), weight(angle)) for angle in angles]


NODES, WEIGHTS = map(list, zip(*chebyshev(POINTS)))


def cardinals(at):
    """The polynomials that are 1 at one node and 0 at the others."""
    angle = math.acos(1.0 - 2.0 * at)
    order = range(1, POINTS)
    nodes = [math.acos(1.0 - 2.0 * node) for node in NODES]
    return [(1.0 + 2.0 * sum(math.cos(k * node) * math.cos(k * angle) for k in order)) / POINTS for node in nodes]


# For each node, and for the end: places before it, weights and polynomials there.
BEFORE = [[(to * at, to * weight, cardinals(to * at)) for at, weight in chebyshev(QUADRATURE)] for to in NODES + [1.0]]


def flight(mode, t_s):
    """State after t from a state of displacement and velocity."""
    omega = math.tau * mode.hz
    ring = omega * math.sqrt(1.0 - mode.damping**2)
    decay = math.exp(-mode.damping * omega * t_s)
    c, s = decay * math.cos(ring * t_s), decay * math.sin(ring * t_s) / ring
    loss = mode.damping * omega
    return [[c + loss * s, s], [-omega * omega * s, c - loss * s]]


def compliance(modes, axis, hz):
    """mm/N"""
    here = [(mode, hz / mode.hz) for mode in modes if mode.axis == axis]
    return sum(1.0 / mode.n_per_mm / complex(1.0 - ratio * ratio, 2.0 * mode.damping * ratio) for mode, ratio in here)


def answers(mode, piece_s):
    """To a force that is 1 at a node: displacement at each node; displacement and velocity at the end."""
    per_mass = (math.tau * mode.hz) ** 2 / mode.n_per_mm

    def integral(to, row):
        sums = [0.0] * POINTS
        for at, weight, values in BEFORE[to]:
            end = 1.0 if to == POINTS else NODES[to]
            kernel = flight(mode, (end - at) * piece_s)[row][1] * weight * piece_s * per_mass
            sums = [total + kernel * value for total, value in zip(sums, values)]
        return sums

    return [integral(to, 0) for to in range(POINTS)], [integral(POINTS, row) for row in (0, 1)]


def solved(matrix, right):
    """Gauss and Jordan."""
    rows = [a + b for a, b in zip(matrix, right)]
    for at in range(len(rows)):
        best = max(range(at, len(rows)), key=lambda row: abs(rows[row][at]))
        rows[at], rows[best] = rows[best], rows[at]
        pivot = [value / rows[at][at] for value in rows[at]]
        rows = [[a - row[at] * b for a, b in zip(row, pivot)] if row[at] else row for row in rows]
        rows[at] = pivot
    return [row[len(rows) :] for row in rows]


class Cut:
    """One tooth's period at one speed. A state: of each mode at the entry, then q at the nodes of the cut before."""

    def __init__(self, milling, rev_per_min):
        self.modes, self.axes = milling.modes, sorted({mode.axis for mode in milling.modes})
        turn_s = 60.0 / rev_per_min
        self.rad_per_s = math.tau / turn_s
        self.tooth_s = turn_s / milling.teeth
        entry_rad, exit_rad = engaged_rad(milling)
        cut_s = turn_s * (exit_rad - entry_rad) / math.tau
        assert cut_s < self.tooth_s * (1.0 + 1e-12), "more than one tooth in the cut: take fewer teeth or less immersion"
        self.pieces = max(2, math.ceil(cut_s * max(mode.hz for mode in milling.modes)))
        self.piece_s = cut_s / self.pieces
        step_rad = (exit_rad - entry_rad) / self.pieces
        self.angles = [[entry_rad + step_rad * (piece + node) for node in NODES] for piece in range(self.pieces)]
        self.cutting = lambda phi_rad: cutting(milling, phi_rad)
        self.answers = [answers(mode, self.piece_s) for mode in self.modes]
        self.rest = [flight(mode, max(self.tooth_s - cut_s, 0.0)) for mode in self.modes]

    def begun(self, pairs):
        """A row over the states of the modes, from pairs of numbers by mode."""
        return [value for at in range(len(self.modes)) for value in pairs.get(at, (0.0, 0.0))]

    def forced(self, shares, axis, h):
        """A row over q at the nodes: what the force -H q answers with on an axis."""
        return [-share * h[at][axis][other] for at, share in enumerate(shares) for other in self.axes]

    def piece(self, angles, depth_mm):
        """Rows from (state, q one tooth before) to (q, state at the end)."""
        h = [[[depth_mm * value for value in row] for row in self.cutting(angle)] for angle in angles]
        size, modes = POINTS * len(self.axes), range(len(self.modes))
        matrix, right = [], []
        for node in range(POINTS):
            for axis in self.axes:
                here = [at for at in modes if self.modes[at].axis == axis]
                shares = [sum(self.answers[at][0][node][to] for at in here) for to in range(POINTS)]
                row = self.forced(shares, axis, h)
                matrix.append([float(column == len(matrix)) - value for column, value in enumerate(row)])
                free = {at: flight(self.modes[at], NODES[node] * self.piece_s)[0] for at in here}
                right.append(self.begun(free) + [-value for value in row])
        q = solved(matrix, right)
        change = [row[:] for row in q]
        for at, row in enumerate(change):
            row[2 * len(self.modes) + at] -= 1.0
        columns = list(zip(*change))
        for at, mode in enumerate(self.modes):
            for shares, pair in zip(self.answers[at][1], flight(mode, self.piece_s)):
                row, free = self.forced(shares, mode.axis, h), self.begun({at: pair}) + [0.0] * size
                q.append([a + dot(row, column) for a, column in zip(free, columns)])
        return q

    def tooth(self, depth_mm):
        """The map from tooth to tooth."""
        pieces = [self.piece(angles, depth_mm) for angles in self.angles]
        states, size = 2 * len(self.modes), POINTS * len(self.axes)

        def passed(vector):
            state, moved = vector[:states], []
            for at, rows in enumerate(pieces):
                given = state + vector[states + at * size : states + (at + 1) * size]
                out = [dot(row, given) for row in rows]
                moved += out[:size]
                state = out[size:]
            rest = [dot(row, state[2 * at : 2 * at + 2]) for at, rows in enumerate(self.rest) for row in rows]
            return rest + moved

        return passed, states + size * len(pieces)

    def multiplier(self, depth_mm):
        """The largest eigenvalue of the map from tooth to tooth."""
        return max(eigenvalues(hessenberg(*self.tooth(depth_mm), KRYLOV)), key=abs)

    def frequency_hz(self, depth_mm, mu):
        """Of those of a vibration with the multiplier mu the one at which the tool goes farthest."""
        passed, size = self.tooth(depth_mm)
        now = [1.0] * size
        for _ in range(SETTLED_TEETH):
            before, now = now, passed(now)
        # What is left is the real part of one eigenvector, turned on by mu.
        vector = [a - mu.conjugate() * b for a, b in zip(now, before)] if mu.imag else now
        moved = vector[2 * len(self.modes) :]
        forces = []
        for at, (angle, weight) in enumerate(zip(sum(self.angles, []), WEIGHTS * self.pieces)):
            q = moved[at * len(self.axes) : (at + 1) * len(self.axes)]
            h = self.cutting(angle)
            time_s = (angle - self.angles[0][0]) / self.rad_per_s
            forces.append((time_s, [weight * sum(h[axis][o] * v for o, v in zip(self.axes, q)) for axis in self.axes]))

        def way(hz):
            turned = [(cmath.exp(-1j * math.tau * hz * time_s), force) for time_s, force in forces]
            sums = [sum(factor * force[at] for factor, force in turned) for at in range(len(self.axes))]
            return sum(abs(compliance(self.modes, axis, hz) * total) ** 2 for axis, total in zip(self.axes, sums))

        last = math.ceil(2.0 * max(mode.hz for mode in self.modes) * self.tooth_s)
        turns = cmath.phase(mu) / math.tau
        return abs(max(((turns + k) / self.tooth_s for k in range(-last, last + 1)), key=way))
