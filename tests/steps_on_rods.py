"""Particles on rods, apart from the program: true motions, and the steps of methods.

Chains swing in angles, which need no rods: their truth is Gragg's extrapolation of order 12. The methods' steps are
written with rods by multipliers, and a projection after each step. For tests/apart_rods.py.
"""

import math

G = 9.81
DOWN = (0.0, 0.0, -G)


def plus(y, h, slope):
    return [a + h * b for a, b in zip(y, slope)]


def solved(matrix, right):
    """The solution of a small system, by elimination with pivots."""
    rows = [row + [value] for row, value in zip(matrix, right)]
    size = len(rows)
    for k in range(size):
        best = max(range(k, size), key=lambda i: abs(rows[i][k]))
        rows[k], rows[best] = rows[best], rows[k]
        for i in range(k + 1, size):
            factor = rows[i][k] / rows[k][k]
            if factor:
                rows[i] = plus(rows[i], -factor, rows[k])
    x = [0.0] * size
    for k in reversed(range(size)):
        x[k] = (rows[k][size] - sum(rows[k][j] * x[j] for j in range(k + 1, size))) / rows[k][k]
    return x


def extrapolated(slope, t, y, h, columns=6):
    """A step of Gragg's rule with 2, 4, ... substeps, extrapolated in their squares."""
    table = []
    for k in range(1, columns + 1):
        part = h / (2 * k)
        before, now = y, plus(y, part, slope(t, y))
        for step in range(1, 2 * k):
            before, now = now, plus(before, 2 * part, slope(t + step * part, now))
        row = [now]
        for j, above in enumerate(table):
            ratio = (k / (k - 1 - j)) ** 2 - 1
            row.append([a + (a - b) / ratio for a, b in zip(row[j], above)])
        table = row
    return table[-1]


# Truths.


def in_angles(masses, lengths, drive=None):
    """The slope of angles from straight down and their rates, of links that hang from a point that moves along x."""
    links = range(len(masses))
    below = [sum(masses[k:]) for k in links]

    def slope(t, y):
        angles, rates = y[: len(masses)], y[len(masses) :]
        matrix, right = [], []
        for i in links:
            row, push = [], -G * below[i] * math.sin(angles[i])
            if drive:
                push -= below[i] * math.cos(angles[i]) * drive(t)[2]
            for j in links:
                both, apart = below[max(i, j)] * lengths[j], angles[i] - angles[j]
                row.append(both * math.cos(apart))
                push -= both * math.sin(apart) * rates[j] ** 2
            matrix.append(row)
            right.append(push)
        return rates + solved(matrix, right)

    return slope


def from_angles(y, lengths, drive=None, t=0):
    """Places and velocities of the links' ends, below each other in the plane y = 0."""
    place, velocity = [0.0] * 3, [0.0] * 3
    if drive:
        place[0], velocity[0], _ = drive(t)
    x, v = [place], [velocity]
    for length, angle, rate in zip(lengths, y, y[len(lengths) :]):
        s, c = length * math.sin(angle), length * math.cos(angle)
        place = plus(place, 1, (s, 0.0, -c))
        velocity = plus(velocity, rate, (c, 0.0, s))
        x, v = x + [place], v + [velocity]
    return x, v


def swung(masses, lengths, angles, h, steps, drive=None, rates=None, parts=1):
    """The true states of a hanging chain at all steps; each is taken in so many parts."""
    slope = in_angles(masses, lengths, drive)
    y = list(angles) + list(rates or [0.0] * len(angles))
    states = [from_angles(y, lengths, drive)]
    for step in range(steps):
        for part in range(parts):
            y = extrapolated(slope, h * (step + part / parts), y, h / parts)
        states.append(from_angles(y, lengths, drive, h * (step + 1)))
    return states


# Particles on rods.


class Rods:
    """Particles of these masses, None where they are fixed, and the pairs that rods join."""

    def __init__(self, masses, pairs, x, drive=None, gravity=DOWN):
        self.weights = [1 / m if m else 0.0 for m in masses]
        self.masses, self.pairs, self.drive, self.gravity = masses, pairs, drive, gravity
        self.lengths = [math.dist(x[i], x[j]) for i, j in pairs]
        self.rate = 0.0

    def directions(self, x):
        found = []
        for i, j in self.pairs:
            apart = plus(x[j], -1, x[i])
            length = math.hypot(*apart)
            found.append((length, [c / length for c in apart]))
        return found

    def multipliers(self, left, right, values):
        """Solves for pulls along `right` that change what is seen along `left` by these values."""
        matrix = []
        for (i, j), (_, n) in zip(self.pairs, left):
            row = []
            for (k, l), (_, m) in zip(self.pairs, right):
                share = self.weights[i] * ((i == k) - (i == l)) - self.weights[j] * ((j == k) - (j == l))
                row.append(share * sum(a * b for a, b in zip(n, m)))
            matrix.append(row)
        return solved(matrix, values)

    def pulled(self, y, pulls, along):
        y = [row[:] for row in y]
        for (i, j), pull, (_, n) in zip(self.pairs, pulls, along):
            y[i] = plus(y[i], self.weights[i] * pull, n)
            y[j] = plus(y[j], -self.weights[j] * pull, n)
        return y

    def parting(self, y, along):
        return [sum(a * (q - p) for a, p, q in zip(n, y[i], y[j])) for (i, j), (_, n) in zip(self.pairs, along)]

    def free(self, t):
        a = [list(self.gravity) if w else [0.0] * 3 for w in self.weights]
        if self.drive:
            a[0][0] = self.drive(t)[2]
        return a

    def acceleration(self, t, x, v):
        along, a = self.directions(x), self.free(t)
        values = self.parting(a, along)
        parting = self.parting(v, along)
        for at, ((i, j), (length, _), wanted) in enumerate(zip(self.pairs, along, self.lengths)):
            values[at] += math.dist(v[i], v[j]) ** 2 / length
            values[at] += self.rate * (2 * parting[at] + self.rate * (length**2 - wanted**2) / (2 * length))
        return self.pulled(a, self.multipliers(along, along, values), along)

    def placed(self, t, x, v):
        if self.drive:
            x, v = [row[:] for row in x], [row[:] for row in v]
            x[0][0], v[0][0], _ = self.drive(t)
        return x, v

    def on_rods(self, x, start=None):
        """Places moved onto the rods, along the rods at their `start` or else where they are."""
        for _ in range(50):
            now = self.directions(x)
            off = [length - wanted for (length, _), wanted in zip(now, self.lengths)]
            if max(map(abs, off)) < 4e-16 * max(self.lengths):
                break
            x = self.pulled(x, self.multipliers(now, start or now, off), start or now)
        return x

    def projected(self, x, v):
        x = self.on_rods(x)
        now = self.directions(x)
        return x, self.pulled(v, self.multipliers(now, now, self.parting(v, now)), now)

    def energy(self, x, v):
        free = [(m, p, u) for m, p, u in zip(self.masses, x, v) if m]
        return sum(m * (math.hypot(*u) ** 2 / 2 - sum(g * c for g, c in zip(self.gravity, p))) for m, p, u in free)


def moved(y, h, slope):
    return [plus(row, h, change) for row, change in zip(y, slope)]


def tableau(*rows):
    """An explicit Runge-Kutta method: the rows of its stages, and last its weights."""

    def step(rods, t, x, v, h):
        places, slopes = [], []
        for row in rows:
            at, to = x, v
            for share, velocity, a in zip(row, places, slopes):
                at, to = moved(at, h * share, velocity), moved(to, h * share, a)
            if row is rows[-1]:
                return at, to
            at, to = rods.placed(t + h * sum(row), at, to)
            places.append(to)
            slopes.append(rods.acceleration(t + h * sum(row), at, to))

    return step


def composition(*stages):
    """Kicks and drifts by parts of the step."""

    def step(rods, t, x, v, h):
        now = t
        for kind, part in stages:
            if kind == "drift":
                x, now = moved(x, h * part, v), now + h * part
            else:
                x, v = rods.placed(now, x, v)
                v = moved(v, h * part, rods.acceleration(now, x, v))
        return x, v

    return step


def shake(rods, t, x, v, h):
    """A half kick, a drift that ends on the rods, a half kick: velocities are left as they come out."""
    old = rods.directions(x)
    if rods.drive is None:
        v = rods.pulled(v, rods.multipliers(old, old, rods.parting(v, old)), old)
    half = moved(v, h / 2, rods.free(t))
    end, _ = rods.placed(t + h, moved(x, h, half), v)
    at = rods.on_rods(end, old)
    v = moved(half, 1 / h, moved(at, -1, end))
    return at, moved(v, h / 2, rods.free(t + h))


def rattle(rods, t, x, v, h):
    x, v = rods.placed(t + h, *shake(rods, t, x, v, h))
    now = rods.directions(x)
    return x, rods.pulled(v, rods.multipliers(now, now, rods.parting(v, now)), now)


METHODS = {
    "rattle": rattle,
    "shake": shake,
    "explicit_euler": tableau([], [1]),
    "symplectic_euler": composition(("kick", 1), ("drift", 1)),
    "symplectic_euler_drift_first": composition(("drift", 1), ("kick", 1)),
    "midpoint": tableau([], [1 / 2], [0, 1]),
    "heun": tableau([], [1], [1 / 2, 1 / 2]),
    "ralston": tableau([], [2 / 3], [1 / 4, 3 / 4]),
    "velocity_verlet": composition(("kick", 1 / 2), ("drift", 1), ("kick", 1 / 2)),
    "position_verlet": composition(("drift", 1 / 2), ("kick", 1), ("drift", 1 / 2)),
    "rk3": tableau([], [1 / 2], [-1, 2], [1 / 6, 2 / 3, 1 / 6]),
    "ssprk3": tableau([], [1], [1 / 4, 1 / 4], [1 / 6, 1 / 6, 2 / 3]),
    "rk4": tableau([], [1 / 2], [0, 1 / 2], [0, 0, 1], [1 / 6, 1 / 3, 1 / 3, 1 / 6]),
}


def run(method, rods, x, v, h, steps, project=True):
    """Each state of a run."""
    yield x, v
    for step in range(steps):
        x, v = rods.placed(h * (step + 1), *METHODS[method](rods, h * step, x, v, h))
        if project and method not in ("rattle", "shake"):
            x, v = rods.projected(x, v)
        yield x, v
