"""Errors of three methods, computed apart from the program: what scenes expect of them.

    pip install numpy mpmath; python3 tests/apart.py

The largest distance of a particle from the truth over the whole steps of a run, m, in numbers of 80 bits. The truth
is Kepler's equation, Jacobi's cn, the modes of a network, or where there is no closed form rk4 at steps so small that
two of them agree.
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


def scene(name, acceleration, x, v, h, duration, truth=None):
    h = REAL(h)
    steps = int(duration / h + REAL("1e-9"))
    times = np.arange(steps + 1) * h
    true = truth(times) if truth else refined(acceleration, x, v, h, steps, 1e-12)
    for method in (symplectic_euler, velocity_verlet, rk4):
        off = path(method, acceleration, x, v, h, steps) - true
        print(f"{name:16} {method.__name__:16} {np.sqrt((off**2).sum(-1)).max():.4e}")


def network(stiffness, masses, gravity):
    """Motion from rest under this matrix and gravity: its acceleration, and its truth by modes."""
    roots = np.sqrt(masses)
    squares, modes = np.linalg.eigh(stiffness / np.outer(roots, roots))
    sag = modes.T @ (gravity * roots) / squares

    def acceleration(x):
        return (gravity - (stiffness @ x[:, 0] / masses))[:, None]

    def truth(times):
        swing = sag * (1 - np.cos(np.outer(times.astype(float), np.sqrt(squares))))
        return (swing @ modes.T / roots)[..., None]

    return acceleration, truth


def path_matrix(free, loose_end):
    """Springs of 1 N/m between a wall and masses in a row, and from the last one to a wall unless its end is loose."""
    matrix = 2 * np.eye(free) - np.eye(free, k=1) - np.eye(free, k=-1)
    matrix[-1, -1] -= loose_end
    return matrix


eight = real(["0.97000436", "-0.24308753"], ["-0.97000436", "0.24308753"], ["0", "0"])
third = real("-0.93240737", "-0.86473146")

scene("kepler", sun, real(["0.5", "0"]), np.sqrt(real(["0", "3"])), "0.01", 10 * np.pi, kepler_equation)
scene("duffing", duffing, real(["1"]), real(["0"]), "0.005", 10, jacobi_cn)
scene("figure_eight", attraction, eight, np.array([-third / 2, -third / 2, third]), "0.001", 6.32591398)
scene("elastic_pendulum", pendulum, real(["1.2", "0"]), real(["0", "0"]), "0.001", 10)

ends = np.full(10, 0.1)
ends[-1] = 0.05
string = network(1000.0 * path_matrix(10, 1), ends, -9.81)
scene("string/hanging", string[0], np.zeros((10, 1)), np.zeros((10, 1)), "0.0005", 2, string[1])
row = path_matrix(9, 0)
both = np.kron(row, np.eye(9)) + np.kron(np.eye(9), row)
net = network(100.0 * both, np.full(81, 0.01), -9.81)
scene("cloth/net", net[0], np.zeros((81, 1)), np.zeros((81, 1)), "0.0005", 1, net[1])
