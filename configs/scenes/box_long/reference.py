#!/usr/bin/python3
"""The numbers that these scenes expect, computed apart from the program.

The stochastic collection equation on drop masses that grow geometrically. Drops that a collision makes
are dealt out to the four masses around theirs so that number, mass and the second and third moments are
those of the collision (the dual of cubic interpolation); steps are those of a fourth-order Runge-Kutta
method. What is left is the error of the kernels' kinks. Masses are laid so that the radius at which a
kernel jumps lies midway between two of them.

    configs/scenes/box_long/reference.py                    prints the numbers, within half an hour
    configs/scenes/box_long/reference.py long 16            one kernel, 16 masses per doubling
    configs/scenes/box_long/reference.py golovin 8          against Golovin's exact solution
"""
import sys

import numpy as np
from scipy.interpolate import CubicSpline

WATER = 1000.0


def mass(radius):
    return WATER * 4 / 3 * np.pi * radius ** 3


def simmel(r):
    """Fall speed of Simmel et al. (2002), m s-1."""
    third = np.cbrt(mass(r) * 1000)  # g^(1/3)
    return np.where(r < 67.215e-6, 4579.5 * third ** 2,
                    np.where(r < 755.82e-6, 49.62 * third,
                             np.where(r < 1738.92e-6, 17.32 * np.sqrt(third), 9.17)))


def beard(r, t=293.15, p=101325.0):
    """Fall speed of Beard (1976), m s-1."""
    eta = 1.72e-5 * 393 / (t + 120) * (t / 273) ** 1.5
    rho = p / (287.05 * t)
    weight = (WATER - rho) * 9.80616
    slip = 1 + 1.255 * 6.62e-8 * (eta / 1.818e-5) * (101325 / p) * np.sqrt(t / 293.15) / r
    stokes = slip * weight * r ** 2 / (4.5 * eta)
    x = np.log(32 * r ** 3 * rho * weight / (3 * eta ** 2))
    middle = slip * eta / (2 * r * rho) * np.exp(np.polyval(
        [-3.27815e-6, 8.55176e-5, -5.78878e-4, -9.87059e-4, -1.53193e-3, 0.992696, -3.18657], x))
    s = np.minimum(r, 3.5e-3)
    tension = 0.0728
    bond = 16 / 3 * weight * s ** 2 / tension
    np_ = (tension ** 3 * rho ** 2 / (eta ** 4 * weight)) ** (1 / 6)
    x = np.log(bond * np_)
    large = eta * np_ / (2 * s * rho) * np.exp(np.polyval(
        [2.38449e-3, -0.0542819, 0.475294, -2.04914, 5.23778, -5.00015], x))
    return np.where(r < 9.5e-6, stokes, np.where(r < 535e-6, middle, large))


def swept(big, small, speed):
    return np.pi * (big + small) ** 2 * np.abs(speed(big) - speed(small))


def long(big, small):
    """Long's efficiency as in Bott (1998) and Simmel et al. (2002), their fall speeds."""
    e = np.clip(4.5e8 * big ** 2 * (1 - 3e-6 / small), 1e-3, 1)
    return np.where(big >= 50e-6, 1, e) * swept(big, small, simmel)


# Hall (1980) as tabulated by Bott (1998): r/R = 0, 0.05 ... 1; radii in um. None: mean of the neighbours.
HALL = {
    10: "0 - .0001 - .014 - .019 - .027 - .033 - .037 - .038 - .036 - .032 - .027",
    20: "0 .0001 .0001 .005 .016 .022 .030 .043 .052 .064 .072 .079 .082 .080 .076 .067 .057 .048 "
        ".040 .033 .027",
    30: "0 - .002 - .040 - .170 - .400 - .550 - .590 - .540 - .490 - .450 - .520",
    40: "0 .001 .070 .28 .500 .62 .680 .74 .780 .80 .800 .80 .780 .77 .760 .77 .770 .78 .790 .95 1.40",
    50: "0 .10 .400 - .700 - .830 - .880 - .900 - .900 - .880 - .890 - 1.01 - 2.30",
    60: "0 .05 .430 .64 .770 .84 .870 .89 .900 .91 .910 .91 .910 .91 .920 .93 .950 1.0 1.03 1.7 3.00",
    70: "0 .20 .580 - .840 - .900 - .940 - .950 - .950 - .950 - 1.00 - 1.04 - 4.00",
    100: "0 .5 .790 .91 .950 .95" + 15 * " 1",
    200: "0 .87 .960 .98" + 17 * " 1",
    300: "0 .97" + 19 * " 1",
}


def hall(big, small):
    """Hall's efficiency, Beard's fall speeds."""
    radii = np.array(list(HALL)) * 1e-6
    rows = np.empty((len(HALL), 21))
    for row, text in zip(rows, HALL.values()):
        given = [None if v == "-" else float(v) for v in text.split()]
        row[:] = [(given[j - 1] + given[j + 1]) / 2 if v is None else v for j, v in enumerate(given)]
    i = np.clip(np.searchsorted(radii, big, side="right") - 1, 0, len(radii) - 2)
    u = (big - radii[i]) / (radii[i + 1] - radii[i])
    column = 20 * small / big
    j = np.minimum(column.astype(int), 19)
    v = column - j
    at = (1 - v) * rows[i, j] + v * rows[i, j + 1]
    above = (1 - v) * rows[i + 1, j] + v * rows[i + 1, j + 1]
    e = np.where(big < 10e-6, 0, np.where(big >= 300e-6, 1, at + u * (above - at)))
    return e * swept(big, small, beard)


def golovin(big, small):
    return 1500 * 4 / 3 * np.pi * (big ** 3 + small ** 3)


# kernel, drops per m3, radius of their mean volume, radius midway between two masses
CASES = {
    "long": (long, 238.7e6, 10e-6, 50e-6),
    "hall": (hall, 238.7e6, 10e-6, 10e-6),
    "hall_30": (hall, 8388608.0, 30.531e-6, 10e-6),
    "golovin": (golovin, 8388608.0, 30.531e-6, 50e-6),
}


class Drops:
    """Numbers per m3 of drops of masses a factor 2^(1/per_doubling) apart, 0.3 um to 17 mm."""

    def __init__(self, case, per_doubling):
        kernel, number, radius, edge = CASES[case]
        h = np.log(2) / per_doubling
        first = np.ceil((np.log(mass(0.3e-6)) - np.log(mass(edge))) / h) - 0.5
        count = int(np.log(mass(17e-3) / mass(0.3e-6)) / h)
        log_mass = np.log(mass(edge)) + h * (first + np.arange(count))
        self.mass = np.exp(log_mass)
        self.radius = np.cbrt(self.mass / mass(1.0))
        x = self.mass / mass(radius)
        self.number = number * x * np.exp(-x) * h  # exponential in volume; converges like exp(-1/h)
        big, small = self.radius[:, None], self.radius[None, :]
        k = np.tril(kernel(big, np.minimum(big, small)))
        k[np.diag_indices(count)] *= 0.5
        # Pairs that make a drop between the larger mass and the next are summed over the smaller one.
        ratio = np.exp(h)
        self.near = int(np.ceil(-np.log(ratio - 1) / h))
        distance = np.arange(count)[:, None] - np.arange(count)[None, :]
        self.far = np.where(distance >= self.near, k, 0)
        self.rates = [np.diagonal(k, -d).copy() for d in range(self.near)]
        self.deals = [self.deal(ratio, d) for d in range(self.near)]
        # Cubic through the masses around, as powers of the small mass over the large one.
        nodes = ratio ** np.arange(-1, 3) - 1
        self.cubic = np.linalg.inv(np.vander(nodes, 4, increasing=True).T)[:, 1:]
        self.powers = (self.mass[:, None] / self.mass[0]) ** np.arange(1, 4)

    @staticmethod
    def deal(ratio, d):
        """Where drops of masses 1 and ratio^-d go: first place above the larger, four weights."""
        made = 1 + ratio ** -float(d)
        place = int(np.floor(np.log(made) / np.log(ratio) + 1e-12))
        nodes = ratio ** np.arange(place - 1.0, place + 3)
        return place - 1, np.linalg.solve(np.vander(nodes, 4, increasing=True).T,
                                          made ** np.arange(4))

    def change(self, n):
        size = len(n)
        out = np.zeros(size + self.near + 8)
        for d in range(self.near):
            rate = self.rates[d] * n[d:] * n[:size - d]
            out[1 + d:1 + size] -= rate
            out[1:1 + size - d] -= rate
            place, weights = self.deals[d]
            for m in range(4):
                at = 1 + d + place + m
                out[at:at + size - d] += weights[m] * rate
        collected = self.far @ (n[:, None] * self.powers)
        collected *= n[:, None] / self.powers
        for m in range(4):
            out[m:m + size] += collected @ self.cubic[m]
        out[1:1 + size] -= n * (n @ self.far)
        return out[1:1 + size]

    def step(self, dt):
        n = self.number
        a = self.change(n)
        b = self.change(n + dt / 2 * a)
        c = self.change(n + dt / 2 * b)
        self.number = n + dt / 6 * (a + 2 * (b + c) + self.change(n + dt * c))

    def beyond(self, radius):
        """Share of the mass in larger drops: the sum up to it, completed by cubic interpolation."""
        water = np.cumsum(self.number * self.mass)
        edges = np.log(self.radius) + 0.5 * np.log(self.radius[1] / self.radius[0])
        return 1 - CubicSpline(edges, water)(np.log(radius)) / water[-1]

    def row(self):
        m = self.mass
        return [self.number.sum(), (self.number * m).sum(), (self.number * m ** 2).sum(),
                self.beyond(40e-6), self.beyond(100e-6)]


    def peaks(self):
        """Local maxima of g(ln r), (um, g m-3)."""
        g = 3 * self.number * self.mass / np.log(self.mass[1] / self.mass[0]) * 1000
        inner = np.flatnonzero((g[1:-1] > g[:-2]) & (g[1:-1] >= g[2:]) & (g[1:-1] > 1e-3)) + 1
        return ", ".join(f"{self.radius[i] * 1e6:.1f} um {g[i]:.4f}" for i in inner)


def solve(case, per_doubling, dt):
    drops = Drops(case, per_doubling)
    half, last = [None, None], drops.row()
    for i in range(1, round(3600 / dt) + 1):
        drops.step(dt)
        t, now = i * dt, drops.row()
        for k in (0, 1):
            if half[k] is None and now[3 + k] >= 0.5:
                half[k] = t - dt * (now[3 + k] - 0.5) / (now[3 + k] - last[3 + k])
        last = now
        if t % 300 == 0:
            print(f"  {t:5.0f} s: {now[0]:.7e} m-3, {now[1]:.10e} kg m-3, second moment {now[2]:.6e} kg2 m-3,"
                  f" beyond 40 um {now[3]:.6f}, 100 um {now[4]:.6f}; peaks {drops.peaks()}", flush=True)
    print(f"  half of the water is in drops beyond 40 um after {half[0]:.1f} s, 100 um {half[1]:.1f} s")


def main():
    asked = [sys.argv[1:3]] if len(sys.argv) > 2 else [
        (case, masses) for case in ("long", "hall", "hall_30") for masses in (8, 16, 32)]
    for case, masses in asked:
        print(f"{case}, {masses} masses per doubling")
        solve(case, int(masses), 1.5 if int(masses) > 16 else 2.0)


if __name__ == "__main__":
    main()
