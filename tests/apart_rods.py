"""What scenes of rods expect, computed apart from the program.

    python3 tests/apart_rods.py [SCENE ...]

Printed are the largest distance of a particle from the truth over the whole steps of a run, and the last, m, with the
largest change of energy, J; energies at rest and work of drives, J; and how far published numbers are met. Needs nothing
but Python; all scenes take a minute or two.
"""

import math
import sys

from steps_on_rods import G, METHODS, Rods, extrapolated, from_angles, plus, run, swung


def off(x, true, free):
    return max(math.dist(x[at], true[at]) for at in free)


def judged(name, rods, truth, h, methods=METHODS, project=True):
    """Prints the errors of these methods, and returns the last states."""
    start, free = rods.energy(*truth[0]), [at for at, m in enumerate(rods.masses) if m]
    ends = {}
    for method in methods:
        errors, energies = [], []
        for (x, v), (true, _) in zip(run(method, rods, *truth[0], h, len(truth) - 1, project), truth):
            errors.append(off(x, true, free))
            energies.append(abs(rods.energy(x, v) - start))
        ends[method] = x, v
        print(f"{name:22} {method:29} {max(errors):.4e} m  last {errors[-1]:.4e} m  energy {max(energies):.4e} J")
    return ends


def chain(name, masses, lengths, angles, h, duration, methods=METHODS, drive=None, rates=None, parts=1):
    """A chain of links below a point, in a plane."""
    steps = round(duration / h)
    truth = swung(masses, lengths, angles, h, steps, drive, rates, parts)
    rods = Rods([None] + masses, [(k, k + 1) for k in range(len(masses))], truth[0][0], drive)
    rods.lengths = lengths
    judged(name, rods, truth, h, methods)
    return rods, truth


def published(name, found, number):
    print(f"{name:22} {'published':29} {number:.10e}, met to {abs(found - number):.0e}")


# The scenes.


def pendulum():
    chain("rods/pendulum", [1.0], [1.0], [math.pi / 2], 0.01, 10)


def double_pendulum():
    _, truth = chain("rods/double_pendulum", [1.0, 1.0], [1.0, 1.0], [math.pi / 2] * 2, 0.001, 5)
    published("x of particle 2, t = 1", truth[1000][0][2][0], -1.4448188499434758)
    published("x of particle 2, t = 5", truth[5000][0][2][0], -1.5507784694704428)


def spherical():
    x, v = [[0.0] * 3, [math.sqrt(0.75), 0.0, -0.5]], [[0.0] * 3, [0.0, 2.0, 0.0]]
    rods = Rods([None, 1.0], [(0, 1)], x)
    rods.lengths = [1.0]

    def slope(t, y):
        return y[3:] + rods.acceleration(t, [x[0], y[:3]], [v[0], y[3:]])[1]

    y, truth = x[1] + v[1], [(x, v)]
    for step in range(1000):
        y = extrapolated(slope, 0.01 * step, y, 0.01)
        truth.append(([x[0], y[:3]], [v[0], y[3:]]))
    return rods, truth


def spherical_pendulum():
    rods, truth = spherical()
    ends = judged("rods/spherical_pendulum", rods, truth, 0.01)
    published("y, t = 10", truth[-1][0][1][1], -0.73774860447066211)
    published("error of rattle, t = 10", off(ends["rattle"][0], truth[-1][0], [1]), 2.8024451662e-3)


def unstabilised():
    rods, truth = spherical()
    kept = [method for method in METHODS if method not in ("rattle", "shake")]
    ends = judged("rods/unstabilised", rods, truth, 0.01, kept, project=False)
    for method, drift in ("rk4", -5.235642e-6), ("symplectic_euler", -3.892893e-2):
        published("drift of " + method, math.hypot(*ends[method][0][1]) - 1, drift)


def baumgarte():
    rods, truth = spherical()
    rods.rate = 10.0
    kept = [method for method in METHODS if method not in ("rattle", "shake")]
    for method, (x, _) in judged("rods/baumgarte", rods, truth, 0.01, kept, project=False).items():
        print(f"{'rods/baumgarte':22} {method:29} {math.hypot(*x[1]) - 1:.4e} m too long at the end")


def polygon(links, span, length):
    """The angles from straight down of the links of a chain between two fixed ends, all nodes of one weight, and the
    horizontal tension in units of that weight."""
    heights = [(links - 1) / 2 - k for k in range(links)]
    low, high = 0.0, 1e3 * links
    for _ in range(200):
        tension = (low + high) / 2
        reach = sum(length / links * tension / math.hypot(tension, rise) for rise in heights)
        low, high = (tension, high) if reach < span else (low, tension)
    return [math.atan2(tension, rise) for rise in heights], tension


def catenary():
    sags = {2: 0.55901699437494742, 4: 0.52431961324224643, 10: 0.50594593157108448, 20: 0.50344663434019265}
    pulls = {2: 0.44721359549995794, 4: 0.81981648046519561, 10: 2.0510510143091193, 20: 4.1078789889260290}
    for links, sag in sags.items():
        angles, tension = polygon(links, 1, 1.5)
        x, _ = from_angles(angles + [0.0] * links, [1.5 / links] * links)
        published(f"sag of {links} rods", -min(p[2] for p in x), sag)
        published(f"pull of {links} rods", tension, pulls[links])
        if links == 10:
            print(f"{'rods/catenary':22} {'energy at rest':29} {0.1 * G * sum(p[2] for p in x[1:-1]):.10e} J")


def falling_rope():
    angles, _ = polygon(10, 1, 1.5)
    _, truth = chain("rods/falling_rope", [0.1] * 10, [0.15] * 10, angles, 0.002, 0.4)
    print(f"{'rods/falling_rope':22} {'its end falls':29} {-truth[-1][0][10][2]:.5f} m")


def dumbbell():
    rods = Rods([1.0, 3.0], [(0, 1)], [[-0.75, 0.0, 0.0], [0.25, 0.0, 0.0]])

    def at(t):
        s, c = math.sin(4 * t), math.cos(4 * t)
        centre, speed = (t, 0.0, 2 * t - G * t * t / 2), (1.0, 0.0, 2 - G * t)
        ends = -0.75, 0.25
        return [plus(centre, r, (c, 0.0, s)) for r in ends], [plus(speed, 4 * r, (-s, 0.0, c)) for r in ends]

    judged("rods/dumbbell", rods, [at(0.01 * step) for step in range(201)], 0.01)
    turned = 2 * (math.asin(0.04) / 0.01 - 4)
    print(f"{'rods/dumbbell':22} {'rattle turns asin(w h) a step':29} {1.5 * math.sin(turned / 2):.4e} m")


def shaken(t):
    return 0.1 * math.sin(3 * t), 0.3 * math.cos(3 * t), -0.9 * math.sin(3 * t)


def driven_pendulum():
    rods, truth = chain("rods/driven_pendulum", [1.0], [1.0], [0.0], 0.01, 10, drive=shaken, rates=[-0.3])
    work = rods.energy(*truth[-1]) - rods.energy(*truth[0])
    print(f"{'rods/driven_pendulum':22} {'work of the drive':29} {work:.8e} J")


def folded_rods():
    chain("hard/folded_rods", [1.0] * 4, [0.25] * 4, [math.pi / 2, -math.pi / 2] * 2, 0.001, 1, parts=2)


def dead_point():
    start, still = [[0.0] * 3, [1.0, 0.0, 0.0]], [[0.0] * 3] * 2
    truth = []
    for x, v in swung([1.0], [1.0], [0.0], 0.001, 1000, rates=[5.0]):
        truth.append((start + [x[1], plus(x[1], 1, start[1])], still + [v[1], v[1]]))
    rods = Rods([None, None, 1.0, 1.0], [(0, 2), (2, 3), (1, 3)], truth[0][0])
    judged("hard/dead_point", rods, truth, 0.001)


def mass_ratio():
    for masses in [1e-3, 1e3], [1e3, 1e-3]:
        chain("hard/rods_mass_ratio", masses, [1.0, 1.0], [0.5, 0.5], 1e-4, 0.2)


def tiny_rod():
    chain("hard/tiny_rod", [1.0], [1.0], [math.pi / 2], 0.01, 1)
    print(f"{'hard/tiny_rod':22} {'Euler in free fall, g h t/2':29} {G * 0.01 / 2:.4e} m")


SCENES = {
    "pendulum": pendulum,
    "double_pendulum": double_pendulum,
    "spherical_pendulum": spherical_pendulum,
    "unstabilised": unstabilised,
    "baumgarte": baumgarte,
    "catenary": catenary,
    "falling_rope": falling_rope,
    "dumbbell": dumbbell,
    "driven_pendulum": driven_pendulum,
    "folded_rods": folded_rods,
    "dead_point": dead_point,
    "mass_ratio": mass_ratio,
    "tiny_rod": tiny_rod,
}

if __name__ == "__main__":
    for scene in sys.argv[1:] or SCENES:
        SCENES[scene]()
