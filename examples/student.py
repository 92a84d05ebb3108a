"""A student's midpoint method for scenes/pa1/scene05.yml, with a mistake that hides well on screen:

python3 examples/student.py mine.npz
springcheck compare mine.npz --scene scenes/pa1/scene05.yml
"""

import sys

import numpy as np

h, steps = 0.0005, 10_000  # s, 1
x, v = np.array([[0, 0, 2], [0, 1, 1.0]]), np.zeros((2, 3))  # m, m/s; particle 0 is fixed
k, rest, m, g = 12.0, 2**0.5, 0.2, np.array([0, 0, -9.81])  # N/m, m, kg, m/s^2


def acceleration(x):
    d = x[0] - x[1]
    a = g + k * (np.linalg.norm(d) - rest) * d / np.linalg.norm(d) / m
    return np.array([np.zeros(3), a])


xs, vs = [x], [v]
for _ in range(steps):
    middle = x + h / 2 * v
    v = v + h * acceleration(middle)
    x = x + h * v  # the mistake: not the velocity at the middle, v0 + h/2 a(x0)
    xs.append(x)
    vs.append(v)
np.savez(sys.argv[1], t=h * np.arange(steps + 1), x=xs, v=vs)
