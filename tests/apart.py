"""Errors of methods and energies at rest, computed apart from the program: what scenes expect.

    pip install numpy mpmath; python3 tests/apart.py

The largest distance of a particle from the truth over the whole steps of a run, and that at its end, m, in numbers of 80
bits (on rods 64). The truth is Kepler's equation, Jacobi's cn, the modes of a network, or where there is no closed form
rk4 at steps so small that two of them agree. Energies at rest are those where no force is left, J. Scenes of rods that do not
hang as chains are in apart_rods.py.
"""

import mpmath
import numpy as np

REAL = np.longdouble


def real(*numbers):
    """An array of numbers that are written in decimals."""
    return np.array(numbers).astype(REAL)


def symplectic_euler(acceleration, x, v, h):
    v = v + h * acceleration(x)
    return x + h * v, v


def velocity_verlet(acceleration, x, v, h):
    v = v + h / 2 * acceleration(x)
    x = x + h * v
    return x, v + h / 2 * acceleration(x)


def rk4(acceleration, x, v, h):
    v1, a1 = v, acceleration(x)
    v2, a2 = v + h / 2 * a1, acceleration(x + h / 2 * v1)
    v3, a3 = v + h / 2 * a2, acceleration(x + h / 2 * v2)
    v4, a4 = v + h * a3, acceleration(x + h * v3)
    return x + h / 6 * (v1 + 2 * v2 + 2 * v3 + v4), v + h / 6 * (a1 + 2 * a2 + 2 * a3 + a4)


def implicit_euler(acceleration, x, v, h):
    """A step of implicit Euler, where the acceleration is linear."""
    unit = np.eye(len(x))[..., None]
    slope = np.array([acceleration(one)[:, 0] - acceleration(0 * one)[:, 0] for one in unit]).T
    matrix = (np.eye(len(x)) - h**2 * slope).astype(float)
    v = np.linalg.solve(matrix, (v + h * acceleration(x)).astype(float))
    return x + h * v, v


def trapezoidal(acceleration, x, v, h):
    return implicit_euler(acceleration, x + h / 2 * v, v + h / 2 * acceleration(x), h / 2)


def tr_bdf2(acceleration, x, v, h):
    part = 2 - np.sqrt(REAL(2))
    weight = 1 / (part * (2 - part))
    middle = trapezoidal(acceleration, x, v, part * h)
    mixed = (weight * at - (weight - 1) * start for at, start in zip(middle, (x, v)))
    return implicit_euler(acceleration, *mixed, (1 - part) / (2 - part) * h)


EXPLICIT = symplectic_euler, velocity_verlet, rk4
IMPLICIT = implicit_euler, trapezoidal, tr_bdf2


def path(method, acceleration, x, v, h, steps):
    """Positions at all whole steps."""
    places = [x]
    for _ in range(steps):
        x, v = method(acceleration, x, v, h)
        places.append(x)
    return np.array(places)


def attraction(x):
    """Of bodies with G m = 1; x is a row for each."""
    apart = x[None] - x[:, None]
    squared = (apart**2).sum(-1) + np.eye(len(x), dtype=REAL)
    return (apart / squared[..., None] ** REAL(1.5)).sum(1)


def sun(x):
    return -x / (x**2).sum() ** REAL(1.5)


def duffing(x):
    return -x - x**3


def pendulum(x):
    """A mass of 1 kg on a spring of 1 m and 50 N/m."""
    length = np.sqrt((x**2).sum())
    return -50 * (length - 1) / length * x + np.array([[0, REAL("-9.81")]])


def kepler_equation(times):
    e, places = REAL("0.5"), []
    for mean in times:
        anomaly = mean
        for _ in range(60):
            anomaly -= (anomaly - e * np.sin(anomaly) - mean) / (1 - e * np.cos(anomaly))
        places.append([[np.cos(anomaly) - e, np.sqrt(1 - e * e) * np.sin(anomaly)]])
    return np.array(places)


def jacobi_cn(times):
    mpmath.mp.dps = 25
    cn = lambda t: mpmath.ellipfun("cn", mpmath.sqrt(2) * mpmath.mpf(str(t)), m=mpmath.mpf(1) / 4)
    return np.array([[[REAL(str(cn(t)))]] for t in times])


def refined(acceleration, x, v, h, steps, within):
    """A truth without closed form: rk4 at h/4 and h/8, extrapolated."""
    coarse, fine = (path(rk4, acceleration, x, v, h / n, n * steps)[::n] for n in (4, 8))
    correction = (fine - coarse) / 15
    assert abs(correction).max() < within
    return fine + correction


def scene(name, acceleration, x, v, h, duration, truth=None, methods=EXPLICIT, within=1e-12):
    h = REAL(h)
    steps = int(duration / h + REAL("1e-9"))
    times = np.arange(steps + 1) * h
    true = truth(times) if truth else refined(acceleration, x, v, h, steps, within)
    for method in methods:
        off = path(method, acceleration, x, v, h, steps) - true
        off = np.sqrt((off**2).sum(-1))
        print(f"{name:19} {method.__name__:16} {off.max():.4e} {off[-1].max():.4e}")


def rest(name, energy):
    print(f"{name:19} {'energy at rest':16} {energy:.7e}")


def network(name, stiffness, masses, gravity, h, duration, x=0, v=0, methods=EXPLICIT):
    """Motion under this matrix and gravity, from places x and velocities v: its truth is that of its modes."""
    x, v = (np.zeros(len(masses)) + start for start in (x, v))
    roots = np.sqrt(masses)
    squares, modes = np.linalg.eigh(stiffness / np.outer(roots, roots))
    # In half turns a second, as sinc counts; what is left of 0 by rounding is a mode that moves freely.
    rates = np.sqrt(np.where(squares > 1e-9 * squares[-1], squares, 0)) / np.pi
    at, speed, pull = (modes.T @ (roots * start) for start in (x, v, gravity))

    def acceleration(x):
        return (gravity - (stiffness @ x[:, 0] / masses))[:, None]

    def truth(times):
        t = times.astype(float)[:, None]
        swing = at * np.cos(np.pi * rates * t) + speed * t * np.sinc(rates * t)
        swing += pull * t**2 / 2 * np.sinc(rates * t / 2) ** 2
        return (swing @ modes.T / roots)[..., None]

    scene(name, acceleration, x[:, None].astype(REAL), v[:, None].astype(REAL), h, duration, truth, methods)


def path_matrix(free, loose=()):
    """Springs of 1 N/m between masses in a row, and from both ends to a wall but where one is loose."""
    matrix = 2 * np.eye(free) - np.eye(free, k=1) - np.eye(free, k=-1)
    matrix[loose, loose] -= 1
    return matrix


def hair(joints, stiffness, length, masses):
    """A hair in a plane, clamped level: springs of N/m between its particles and hinges of N m/rad at joints."""
    weight = masses[:, None] * np.array([0, REAL("-9.81")])

    def acceleration(x):
        links = np.diff(x, axis=0, prepend=REAL(0))
        lengths = np.sqrt((links**2).sum(-1))[:, None]
        angles = np.unwrap(np.arctan2(links[:, 1], links[:, 0]))
        moments = joints * np.diff(angles, prepend=REAL(0))
        torques = moments - np.append(moments[1:], 0)
        across = np.stack([-links[:, 1], links[:, 0]], -1) / lengths**2
        pulls = stiffness * (1 - length / lengths) * links + torques[:, None] * across
        return (weight - pulls + np.append(pulls[1:], np.zeros((1, 2)), 0)) / masses[:, None]

    return acceleration


def hair_at_rest(joints, stiffness, length, masses):
    """Its energy where no force is left: from the angle of the tip, which is found, link by link to the clamp."""
    below = REAL("9.81") * np.cumsum(masses[::-1])[::-1]

    def shape(tip):
        angles, moment = [tip], 0
        for joint, load in zip(joints[::-1], below[::-1]):
            moment += (length - load * np.sin(angles[-1]) / stiffness) * load * np.cos(angles[-1])
            angles.append(angles[-1] + moment / joint)
        return np.array(angles[::-1])

    low, high = -REAL(np.pi) / 2, REAL(0)
    for _ in range(70):
        middle = (low + high) / 2
        low, high = (middle, high) if shape(middle)[0] < 0 else (low, middle)
    angles = shape(low)
    stretch = -below * np.sin(angles[1:]) / stiffness
    bending, springs = (joints * np.diff(angles) ** 2).sum() / 2, (stiffness * stretch**2).sum() / 2
    return bending + springs + (below * (length + stretch) * np.sin(angles[1:])).sum()


def cloth_at_rest(sides, mass, stiffnesses, wind=0, limit=None):
    """The energy of a cloth of 7 x 7 in 1 m x 1 m where no force is left, and how far its worst spring is stretched.

    It hangs by two corners at z = 1 m, in air of 1.2 kg/m³ that moves along y where there is a wind, m/s. Springs that
    would be longer than at rest by more than the limit are held at it by forces, which an augmented Lagrangian finds.
    """
    grid = np.indices((7, 7)).reshape(2, -1).T
    start = [0, 0, 1] + grid / 6 @ np.array(sides, float)
    cells = ((grid[:, None] - grid) ** 2).sum(-1)
    springs = sum(k * (cells == apart) for apart, k in zip((1, 2, 4), stiffnesses))
    lengths = np.sqrt(cells) / 6
    share = np.array([0.5, 1, 1, 1, 1, 1, 0.5]) / 6
    masses = mass * np.outer(share, share).ravel()
    first = np.arange(49).reshape(7, 7)[:-1, :-1].ravel()
    triangles = np.concatenate([np.stack([first, first + 7, first + 8], 1), np.stack([first, first + 8, first + 1], 1)])
    free = np.setdiff1d(np.arange(49), [0, 42])

    longest = lengths * (1 + (limit or 0))
    held, hard = np.zeros((49, 49)), 1000

    def holding(now):
        """What holds springs at the limit: it pulls, and pushes none."""
        pull = (held + hard * (now - longest)) * (springs > 0) * (limit is not None)
        return np.where(pull.real > 0, pull, 0)

    def force(x):
        apart = x[None] - x[:, None]
        now = np.sqrt((apart**2).sum(-1) + np.eye(49))
        pulls = springs * (now - lengths) + holding(now)
        forces = ((pulls / now)[..., None] * apart).sum(1) + masses[:, None] * [0, 0, -9.81]
        a, b, c = (x[triangles[:, corner]] for corner in range(3))
        twice = np.cross(b - a, c - a)
        area = np.sqrt((twice**2).sum(-1, keepdims=True)) / 2
        # What is at rest moves at -w past the air. A root for the size, since x may be complex.
        along = -wind * twice[:, 1:2] / (2 * area)
        drag = -1.2 / 2 * np.sqrt(along**2) * along * twice / 2
        for corner in range(3):
            np.add.at(forces, triangles[:, corner], drag / 3)
        return forces

    x, v = start, np.zeros((49, 3))
    for _ in range(10000):
        v[free] += 0.002 * (force(x)[free] / masses[free, None] - 2 * v[free])
        x = x + 0.002 * v
    # Newton's method, with derivatives by a step along the imaginary axis.
    unknown = (3 * free[:, None] + np.arange(3)).ravel()
    for _ in range(8 if limit is None else 60):
        columns = []
        for at in unknown:
            moved = x.astype(complex)
            moved.flat[at] += 1e-30j
            columns.append(force(moved).flat[unknown].imag / 1e-30)
        x.flat[unknown] -= np.linalg.solve(np.array(columns).T, force(x).flat[unknown])
        held = holding(np.sqrt(((x[None] - x[:, None]) ** 2).sum(-1)))
    assert abs(force(x)[free]).max() < (1e-12 if limit is None else 1e-5)
    now = np.sqrt(((x[None] - x[:, None]) ** 2).sum(-1))
    energy = (springs * (now - lengths) ** 2).sum() / 4 + 9.81 * (masses * x[:, 2])[free].sum()
    return energy, (now[springs > 0] / lengths[springs > 0]).max() - 1


class Rods:
    """A chain of equal rods and particles that hangs from the origin, x sideways and z up; masses cancel."""

    def __init__(self, rods, length, gravity=9.81):
        self.rods, self.length, self.gravity = rods, length, gravity
        # The rows of G without directions: a rod goes from the particle before to its own.
        self.ends = np.eye(rods) - np.eye(rods, k=-1)
        self.below = rods - np.maximum.outer(np.arange(rods), np.arange(rods))

    def solved(self, x, right):
        """Lagrange multipliers y of (G Gᵀ) y = right as their pulls Gᵀ y."""
        directions = self.ends @ x
        directions /= np.sqrt((directions**2).sum(-1, keepdims=True))
        gram = (self.ends @ self.ends.T) * (directions @ directions.T)
        return self.ends.T @ (np.linalg.solve(gram, right)[:, None] * directions)

    def along(self, x, y):
        """Parts of the rods' differences of y along them."""
        directions = self.ends @ x
        return (directions * (self.ends @ y)).sum(-1) / np.sqrt((directions**2).sum(-1))

    def acceleration(self, x, v):
        free = np.tile([0.0, -self.gravity], (self.rods, 1))
        turning = ((self.ends @ v) ** 2).sum(-1) / np.sqrt(((self.ends @ x) ** 2).sum(-1))
        return free - self.solved(x, self.along(x, free) + turning)

    def off(self, x):
        return np.sqrt(((self.ends @ x) ** 2).sum(-1)) - self.length

    def projected(self, x, v):
        for _ in range(6):
            x = x - self.solved(x, self.off(x))
        return x, v - self.solved(x, self.along(x, v))

    def symplectic_euler(self, x, v, h):
        v = v + h * self.acceleration(x, v)
        return self.projected(x + h * v, v)

    def velocity_verlet(self, x, v, h):
        v = v + h / 2 * self.acceleration(x, v)
        x = x + h * v
        return self.projected(x, v + h / 2 * self.acceleration(x, v))

    def rk4(self, x, v, h):
        v1, a1 = v, self.acceleration(x, v)
        v2, a2 = v + h / 2 * a1, self.acceleration(x + h / 2 * v1, v + h / 2 * a1)
        v3, a3 = v + h / 2 * a2, self.acceleration(x + h / 2 * v2, v + h / 2 * a2)
        v4, a4 = v + h * a3, self.acceleration(x + h * v3, v + h * a3)
        x = x + h / 6 * (v1 + 2 * v2 + 2 * v3 + v4)
        return self.projected(x, v + h / 6 * (a1 + 2 * a2 + 2 * a3 + a4))

    def rattle(self, x, v, h):
        weight = np.array([0.0, -self.gravity])
        v = v + h / 2 * weight
        end = x + h * v
        for _ in range(40):
            end = end - self.solved(x, self.off(end))
        return end, self.projected(end, (end - x) / h + h / 2 * weight)[1]

    def angles(self, a):
        """Angles' accelerations, from straight down: the pendulum's equations without multipliers."""
        a, rates = a
        apart = a[:, None] - a
        pulls = (self.below * np.sin(apart)) @ rates**2
        pulls += self.gravity / self.length * np.diag(self.below) * np.sin(a)
        return np.array([rates, -np.linalg.solve(self.below * np.cos(apart), pulls)])

    def true(self, rates, h, steps):
        """Positions at all whole steps: rk4 on angles, at h/8 and h/16, extrapolated."""
        runs = []
        for parts in (8, 16):
            a, d, kept = np.array([np.zeros(self.rods), rates]), h / parts, []
            for step in range(parts * steps + 1):
                if step % parts == 0:
                    kept.append(a[0])
                k1 = self.angles(a)
                k2 = self.angles(a + d / 2 * k1)
                k3 = self.angles(a + d / 2 * k2)
                a = a + d / 6 * (k1 + 2 * k2 + 2 * k3 + self.angles(a + d * k3))
            runs.append(np.array(kept))
        correction = (runs[1] - runs[0]) / 15
        assert abs(correction).max() < 1e-9
        at = runs[1] + correction
        return self.length * np.stack([np.sin(at).cumsum(-1), -np.cos(at).cumsum(-1)], -1)


def rods_scene(name, chain, speed, h, duration):
    """The chain, its lowest particle pushed at this speed, the others in proportion to their depth."""
    steps = round(duration / h)
    true = chain.true(np.full(chain.rods, speed / (chain.rods * chain.length)), h, steps)
    depth = chain.length * np.arange(1, chain.rods + 1)
    start = np.stack([0 * depth, -depth], -1), np.stack([speed * depth / depth[-1], 0 * depth], -1)
    for method in chain.rattle, chain.symplectic_euler, chain.velocity_verlet, chain.rk4:
        (x, v), worst = start, 0
        for at in true[1:]:
            x, v = method(x, v, h)
            worst = max(worst, np.sqrt(((x - at) ** 2).sum(-1)).max())
        print(f"{name:19} {method.__name__:16} {worst:.4e}")


def springs_in_row(stiffness, length, mass):
    """Accelerations of equal masses on equal springs that hang from the origin."""

    def acceleration(x):
        links = np.diff(x, axis=0, prepend=0 * x[:1])
        now = np.sqrt((links**2).sum(-1, keepdims=True))
        pulls = stiffness * (1 - length / now) * links
        pulls[:-1] -= pulls[1:].copy()
        return -pulls / mass + real("0", "-9.81")

    return acceleration


eight = real(["0.97000436", "-0.24308753"], ["-0.97000436", "0.24308753"], ["0", "0"])
third = real("-0.93240737", "-0.86473146")

scene("kepler", sun, real(["0.5", "0"]), np.sqrt(real(["0", "3"])), "0.01", 10 * np.pi, kepler_equation)
scene("duffing", duffing, real(["1"]), real(["0"]), "0.005", 10, jacobi_cn)
scene("figure_eight", attraction, eight, np.array([-third / 2, -third / 2, third]), "0.001", 6.32591398)
scene("elastic_pendulum", pendulum, real(["1.2", "0"]), real(["0", "0"]), "0.001", 10)

weights = np.full(11, 0.1)
weights[[0, 10]] = 0.05
network("string/hanging", 1000 * path_matrix(10, [-1]), weights[1:], -9.81, "0.0005", 2)
network("string/falling", 1000 * path_matrix(11, [0, -1]), weights, -9.81, "0.0005", 1, -0.01 * np.arange(11))
sag = np.append(0, np.linalg.solve(1000 * path_matrix(20, [-1]), np.full(20, -0.05 * 9.81)))
network("string/slinky", 1000 * path_matrix(21, [0, -1]), np.full(21, 0.05), -9.81, "0.0005", 0.3, sag)
network("string/wave", 1000 * path_matrix(39), np.full(39, 0.05), 0, "0.0005", 0.6, v=np.eye(39)[19])
row = path_matrix(9)
both = np.kron(row, np.eye(9)) + np.kron(np.eye(9), row)
network("cloth/net", 100 * both, np.full(81, 0.01), -9.81, "0.0005", 1)

joints, tapered = np.full(8, REAL("0.005")), np.full(8, REAL("0.00125"))
joints[0] *= 2
tapered[-1] /= 2
level = np.stack([REAL("0.025") * np.arange(1, 9), np.zeros(8, REAL)], -1)
clamped = hair(joints, 2000, REAL("0.025"), tapered)
scene("hair/clamped", clamped, level, np.zeros((8, 2), REAL), "0.0002", 0.5, within=1e-11)
# Angles of links that are nearly level: the differences of heights over their length; of hinges, those of angles.
angles = (np.eye(8) - np.eye(8, k=-1)) / 0.025
turns = (np.eye(8) - np.eye(8, k=-1)) @ angles
stiff = turns.T @ (10000 * joints.astype(float)[:, None] * turns)
network("hard/stiff_hair", stiff, tapered.astype(float), -9.81, "0.0005", 0.1, methods=IMPLICIT)
rest("hair/own_weight", hair_at_rest(joints, 500, REAL("0.025"), tapered))
for name, *of in (
    ("cloth/overstretched", [[1, 0, 0], [0, 1, 0]], 1, [20, 10, 5]),
    ("cloth/curtain", [[1, 0, 0], [0, 0, -1]], 0.3, [100, 50, 20], 1),
    ("strain/cloth", [[1, 0, 0], [0, 1, 0]], 1, [20, 10, 5], 0, 0.1),
):
    energy, stretch = cloth_at_rest(*of)
    rest(name, energy)
    print(f"{name:19} {'worst spring':16} {stretch:.4f}")

rods_scene("rods/chain", Rods(20, 0.05), 0.05, 0.002, 2)
depth = REAL("0.05") * np.arange(1, 21)
hanging, pushed = np.stack([0 * depth, -depth], -1), np.stack([REAL("0.05") * depth, 0 * depth], -1)
springs = springs_in_row(REAL(2e6), REAL("0.05"), REAL("0.05"))
scene("rods/chain_springs", springs, hanging, pushed, "0.0001", 2, within=1e-9)
