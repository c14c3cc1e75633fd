#!/usr/bin/python3
"""The numbers that these scenes expect, computed apart from the program.

Equilibrium: the initial profile shifted by the lift and brought to saturation at each height. With
droplets: parcels 5 m apart whose droplets grow by diffusion, in explicit steps of 0.05 s. Liquid water
path from 0 to 3000 m in kg m-2.

    configs/scenes/kid_1d/reference.py               prints both, within minutes
"""
import numpy as np

G, C_P, R_D, P_00, L, EPSILON, WATER = 9.81, 1005.0, 287.04, 1e5, 2.5e6, 0.622, 1000.0
R_V = R_D / EPSILON
HEIGHTS, THETA, RATIO = (0.0, 740.0, 3260.0), (297.9, 297.9, 312.66), (0.015, 0.0138, 0.0024)
THETA_V = [t * (1 + 0.608 * r / (1 + r)) for t, r in zip(THETA, RATIO)]


def exner(z, p_s):
    """Hydrostatic Exner function of the initial profile, exact on each of its segments."""
    slopes = np.diff(THETA_V) / np.diff(HEIGHTS)
    h = np.clip(z, 0, HEIGHTS[2])
    low, high = np.minimum(h, HEIGHTS[1]), np.maximum(h - HEIGHTS[1], 0)
    fall = (np.log1p(slopes[0] * low / THETA_V[0]) / slopes[0]
            + np.log1p(slopes[1] * high / THETA_V[1]) / slopes[1])
    fall += np.where(z > h, (z - h) / THETA_V[2], np.minimum(z, 0) / THETA_V[0])
    return (p_s / P_00) ** (R_D / C_P) - G / C_P * fall


def saturation(t, p):
    """Vapour pressure (Bolton 1980) and mixing ratio."""
    e = 611.2 * np.exp(17.67 * (t - 273.15) / (t - 29.65))
    return e, EPSILON * e / (p - e)


def growth(t, p):
    """G of r dr/dt = G s (Rogers and Yau 1989, 7.17)."""
    diffusivity = 2.11e-5 * (t / 273.15) ** 1.94 * (101325 / p)
    conductivity = 4.3783e-3 + 7.1128e-5 * t
    return 1 / (WATER * R_V * t / (diffusivity * saturation(t, p)[0])
                + WATER * L / (conductivity * t) * (L / (R_V * t) - 1))


def lift(w, t):
    return w * 600 / np.pi * (1 - np.cos(np.pi * min(t, 600) / 600))


class Column:
    """Parcels that start dz apart, seen at heights from the ground to 3000 m."""

    def __init__(self, w, p_s, frozen, dz):
        self.w, self.p_s, self.frozen, self.dz = w, p_s, frozen, dz
        self.start = np.arange(-1300 + dz / 2, 3400, dz)
        self.theta = np.interp(self.start, HEIGHTS, THETA)
        self.vapour = np.interp(self.start, HEIGHTS, RATIO)
        self.cloud = np.zeros_like(self.start)

    def air(self, t, theta):
        """(height, Exner function, pressure, temperature)"""
        z = self.start + lift(self.w, t)
        pi = exner(z, self.p_s)
        of = np.interp(z, HEIGHTS, THETA) if self.frozen else theta
        return z, pi, P_00 * pi ** (C_P / R_D), pi * of

    def path(self, t, what):
        z, _, p, _ = self.air(t, self.theta)
        density = p / (R_D * exner(z, self.p_s) * np.interp(z, HEIGHTS, THETA_V))
        return (density * what)[(z > 0) & (z < 3000)].sum() * self.dz

    def adjusted(self, t):
        """Cloud water at saturation."""
        _, pi, p, first = self.air(t, self.theta)
        if self.frozen:
            return np.maximum(0, self.vapour - saturation(first, p)[1])
        warm = first
        for _ in range(40):
            e, q = saturation(warm, p)
            slope = q * 17.67 * 243.5 / (warm - 29.65) ** 2 * p / (p - e)
            warm = warm - (warm - first - L / C_P * (self.vapour - q)) / (1 + L / C_P * slope)
        cloudy = self.vapour > saturation(first, p)[1]
        return np.where(cloudy, self.vapour - saturation(warm, p)[1], 0)

    def grow(self, number, end, dt=0.05):
        """Droplets of 1 um, `number` per kg, where air is supersaturated first; the midpoint rule."""
        embryo = 4 / 3 * np.pi * WATER * 1e-18
        n = np.zeros_like(self.start)

        def rate(t, theta, vapour, cloud):
            _, pi, p, temperature = self.air(t, theta)
            radius = np.cbrt(np.maximum(cloud, n * embryo) / np.maximum(n, 1) * 3 / (4 * np.pi * WATER))
            s = vapour / saturation(temperature, p)[1] - 1
            taken = 4 * np.pi * WATER * n * radius * growth(temperature, p) * s
            return np.where((cloud <= 0) & (taken < 0), 0, taken), L / (C_P * pi) * (not self.frozen)

        for i in range(round(end / dt)):
            t = i * dt
            _, _, p, temperature = self.air(t, self.theta)
            n = np.where((self.vapour > saturation(temperature, p)[1]) & (n == 0), number, n)
            half, warming = rate(t, self.theta, self.vapour, self.cloud)
            half = 0.5 * dt * half
            middle, warming = rate(t + 0.5 * dt, self.theta + warming * half, self.vapour - half,
                                   self.cloud + half)
            taken = np.maximum(middle * dt, -self.cloud)
            self.vapour, self.cloud = self.vapour - taken, self.cloud + taken
            self.theta = self.theta + warming * taken


def main():
    for frozen in (False, True):
        print("temperature of each height" if frozen else "with latent heating")
        for p_s in (1e5, 1.007e5):
            for w in (1, 2, 3):
                column = Column(w, p_s, frozen, 1.0)
                paths = [column.path(t, column.adjusted(t)) for t in (300, 600)]
                print(f"  {p_s / 100:.0f} hPa, {w} m/s: {paths[0]:.4f} {paths[1]:.4f} kg m-2, "
                      f"largest {1e3 * column.adjusted(600).max():.3f} g/kg", flush=True)
        for number in (50e6, 500e6, 5000e6):
            column = Column(2, 1e5, frozen, 5.0)
            column.grow(number, 300)
            _, _, p, temperature = column.air(300, column.theta)
            excess = np.where(column.cloud > 0, column.vapour - saturation(temperature, p)[1], 0)
            print(f"  1000 hPa, 2 m/s, {number / 1e6:.0f} droplets per cm3 at 300 s: liquid "
                  f"{column.path(300, column.cloud):.4f}, vapour above saturation "
                  f"{column.path(300, excess):.4f} kg m-2, "
                  f"supersaturation up to {100 * (excess / (column.vapour - excess)).max():.2f} %",
                  flush=True)


if __name__ == "__main__":
    main()
