#!/usr/bin/python3
"""The numbers that these scenes expect, by an integration of its own (LSODA, relative tolerance
1e-9): every size of particle grows by itself in the air of one parcel.

    configs/scenes/parcel_activation/reference.py           all cases, within minutes
    configs/scenes/parcel_activation/reference.py 1 pristine     those whose name holds a word
    configs/scenes/parcel_activation/reference.py --table [...]  with the table's fall of pressure
    configs/scenes/parcel_activation/reference.py --curves FILE  supersaturation and number over height

Aerosol of several sizes is cut into 120 bins per mode within 4.5 standard deviations; the bins that
hold the smallest droplet are cut into 20 and integrated once more, so that numbers of droplets are
known to 0.1 %. "activated" counts dry sizes whose critical supersaturation is below S_max, "at the
end" and "most" those beyond their critical radius at the end and at most.

Temperature falls by g/c_p and pressure by p g/(R_d T), so that dry ascent keeps the potential
temperature of dry air. In the table of README.md temperature falls so too, but pressure by the density of
moist air.
"""
import sys

import numpy as np
from scipy.integrate import solve_ivp
from scipy.interpolate import CubicSpline
from scipy.optimize import brentq, minimize_scalar
from scipy.special import erf

G, R_D, R_V, C_P, L = 9.80616, 287.05, 461.5, 1005.7, 2.501e6
EPSILON, WATER, TENSION = R_D / R_V, 1000.0, 0.072
SPHERE = 4 / 3 * np.pi * WATER
OF_MOIST_AIR = "--table" in sys.argv
STANDARD = 101325 / (R_D * 288.15)  # kg m-3, density of the standard atmosphere

# m-3, m, deviation, hygroscopicity
CONTINENTAL = [(1000e6, 50e-9, 2.0, 0.61)]
PRISTINE = [(125e6, 11e-9, 1.2, 1.28), (65e6, 60e-9, 1.7, 1.28)]  # Grabowski and Pawlowska 2023
POLLUTED = [(160e6, 29e-9, 1.36, 1.28), (380e6, 71e-9, 1.57, 1.28)]


def vapour_pressure(t):
    """Over liquid water, Pa (Bolton 1980)."""
    return 611.2 * np.exp(17.67 * (t - 273.15) / (t - 29.65))


def saturation(t, p, vapour):
    """e/e_s, vapour per mass of dry air."""
    return p * vapour / ((EPSILON + vapour) * vapour_pressure(t))


def kelvin_length(t):
    return 2 * TENSION / (WATER * R_V * t)


def equilibrium(r, dry, kappa, t):
    """Saturation ratio over a droplet (Petters and Kreidenweis 2007)."""
    cubes = r ** 3 - dry ** 3
    return cubes / (cubes + kappa * dry ** 3) * np.exp(kelvin_length(t) / r)


def growth(r, t, p, accommodation):
    """G of r dr/dt = G (S - S_eq), m2 s-1 (Rogers and Yau 1989, 7.17; Fuchs and Sutugin 1971)."""
    diffusivity = 2.11e-5 * (t / 273.15) ** 1.94 * (101325 / p)
    conductivity = 4.3783e-3 + 7.1128e-5 * t

    def transition(knudsen, share):
        a = 4 / (3 * share)
        return (1 + knudsen) / (1 + (a + 0.377) * knudsen + a * knudsen ** 2)
    vapour = transition(2 * diffusivity / np.sqrt(2 * R_V * t) / r, accommodation)
    heat = transition(0.8 * conductivity * t / (p * np.sqrt(2 * R_D * t)) / r, 1.0)
    return 1 / (WATER * R_V * t / (diffusivity * vapour * vapour_pressure(t))
                + WATER * L / (conductivity * heat * t) * (L / (R_V * t) - 1))


def critical(dry, kappa, t):
    """(radius, saturation ratio) at which S_eq is largest."""
    found = minimize_scalar(lambda x: -equilibrium(np.exp(x), dry, kappa, t), method="bounded",
                            bounds=(np.log(dry * 1.0001), np.log(dry * 1e4)),
                            options={"xatol": 1e-10})
    return np.exp(found.x), -found.fun


class Bins:
    """Dry radius, hygroscopicity and number per mass of air, of every bin."""

    def __init__(self, modes, density, count, fine=()):
        """`fine`: (mode, radius), where bins are cut into 20."""
        dry, kappa, number, mode = [], [], [], []
        for k, (total, radius, deviation, hygroscopicity) in enumerate(modes):
            if deviation == 1:
                dry, kappa, number, mode = [radius], [hygroscopicity], [total / density], [k]
                continue
            width = np.log(deviation)
            edges = list(np.linspace(-4.5, 4.5, count + 1))
            for where in (np.log(r / radius) / width for m, r in fine if m == k):
                i = int(np.searchsorted(edges, where)) - 1
                lowest, highest = max(0, i - 1), min(len(edges) - 1, i + 2)
                edges[lowest:highest + 1] = np.linspace(edges[lowest], edges[highest], 61)
            edges = np.array(edges)
            dry += list(radius * np.exp(width * 0.5 * (edges[1:] + edges[:-1])))
            number += list(np.diff(0.5 * erf(edges / np.sqrt(2))) * total / density)
            kappa += [hygroscopicity] * (len(edges) - 1)
            mode += [k] * (len(edges) - 1)
        self.dry, self.kappa = np.array(dry), np.array(kappa)
        self.number, self.mode = np.array(number), np.array(mode)


class Parcel:
    """State: ln r of every bin, temperature, ln p."""

    def __init__(self, bins, t, p, humidity, speed, accommodation, fall_of_pressure=None):
        """`fall_of_pressure(time, t)`: d ln p/dz, of hydrostatic air as warm as the parcel unless
        stated."""
        self.bins, self.speed, self.accommodation = bins, speed, accommodation
        self.fall_of_pressure = fall_of_pressure or (lambda _, t: -G / (R_D * t))
        at_rest = [brentq(lambda x: equilibrium(np.exp(x), d, k, t) - humidity,
                          np.log(d * (1 + 1e-12)), np.log(critical(d, k, t)[0]), xtol=1e-15)
                   for d, k in zip(bins.dry, bins.kappa)]
        self.start = np.array(at_rest + [t, np.log(p)])
        e = humidity * vapour_pressure(t)
        self.all_water = EPSILON * e / (p - e) + self.liquid(np.exp(self.start[:-2]))

    def liquid(self, r):
        return SPHERE * np.sum(self.bins.number * (r ** 3 - self.bins.dry ** 3))

    def saturation(self, y):
        return saturation(y[-2], np.exp(y[-1]), self.all_water - self.liquid(np.exp(y[:-2])))

    def slope(self, time, y):
        r, t, p = np.exp(y[:-2]), y[-2], np.exp(y[-1])
        rate = (growth(r, t, p, self.accommodation) / r ** 2
                * (self.saturation(y) - equilibrium(r, self.bins.dry, self.bins.kappa, t)))
        condensed = 3 * SPHERE * np.sum(self.bins.number * r ** 3 * rate)
        fall = self.speed(time) * self.fall_of_pressure(time, t)
        warming = R_D * t / C_P * fall + L / C_P * condensed
        if OF_MOIST_AIR:
            fall /= 1 + 0.608 * (self.all_water - self.liquid(r))
        return np.append(rate, [warming, fall])

    def integrate(self, times):
        """States at the times (a row each)."""
        found = solve_ivp(self.slope, (times[0], times[-1]), self.start, method="LSODA",
                          t_eval=times, rtol=1e-9, atol=1e-11,
                          max_step=(times[-1] - times[0]) / 300)
        assert found.success, found.message
        return found.y.T


def peak_of(times, values):
    """Largest value and its time, by a parabola through three."""
    i = int(np.argmax(values))
    if i in (0, len(values) - 1):
        return values[i], times[i]
    before, at, after = values[i - 1:i + 2]
    x = 0.5 * (before - after) / (before - 2 * at + after)
    return at - 0.25 * (before - after) * x, times[i] + x * (times[1] - times[0])


def activated(bins, states):
    """Whether each bin is beyond its critical radius, a row per state."""
    middle = states[:, -2].mean()
    # r_c at one temperature, and how it depends on it: ln r_c is close to linear in ln T.
    at = {}
    for t in (middle, middle * 1.01):
        at[t] = np.array([np.log(critical(d, k, t)[0]) for d, k in zip(bins.dry, bins.kappa)])
    slope = (at[middle * 1.01] - at[middle]) / np.log(1.01)
    return states[:, :-2] > at[middle] + np.log(states[:, -2:-1] / middle) * slope


def smallest_droplets(bins, beyond):
    """(mode, radius) midway between the largest haze particle and the smallest droplet."""
    found = []
    for mode in range(bins.mode.max() + 1):
        dry = bins.dry[bins.mode == mode]
        is_droplet = beyond[bins.mode == mode]
        i = int(np.argmax(is_droplet))
        if is_droplet.any() and i > 0:
            found.append((mode, np.sqrt(dry[i - 1] * dry[i])))
    return found


def below(modes, density, s, t):
    """Number per mass of air whose critical supersaturation is below s."""
    total = 0
    for number, radius, deviation, kappa in modes:
        def lacks(x):
            return critical(np.exp(x), kappa, t)[1] - 1 - s
        x = brentq(lacks, np.log(1e-9), np.log(5e-6))
        total += 0.5 * number / density * (1 - erf((x - np.log(radius)) / np.log(deviation)
                                                   / np.sqrt(2)))
    return total


def ascend(w, rise, modes, t, humidity, accommodation, p=9e4, count=120):
    """One ascent at constant speed."""
    density = p / (R_D * t)
    times = np.linspace(0, rise / w, int(round(rise / w / min(0.1, 0.1 / w))) + 1)
    bins = Bins(modes, density, count)
    states = Parcel(bins, t, p, humidity, lambda _: w, accommodation).integrate(times)
    beyond = activated(bins, states)
    fine = smallest_droplets(bins, beyond[-1]) + smallest_droplets(bins, beyond.any(axis=0))
    bins = Bins(modes, density, count, fine)
    parcel = Parcel(bins, t, p, humidity, lambda _: w, accommodation)
    states = parcel.integrate(times)
    numbers = activated(bins, states) @ bins.number * density
    excess = np.array([parcel.saturation(y) for y in states]) - 1
    peak, when = peak_of(times, excess)
    warmth = np.interp(when, times, states[:, -2])
    return {"peak": peak, "time": when, "critical": below(modes, density, peak, warmth) * density,
            "end": numbers[-1], "most": numbers.max(),
            "liquid": parcel.liquid(np.exp(states[-1, :-2])), "t": states[-1, -2],
            "z": times * w, "excess": excess, "numbers": numbers,
            "theta": states[:, -2] * (1e5 / np.exp(states[:, -1])) ** (R_D / C_P)}


def up_and_down(w, number, radius):
    """Arabas and Shima 2017: one kind of particle lifted by 150 m and lowered again."""
    modes = [(number, radius, 1, 1.28)]
    bins = Bins(modes, STANDARD, 1)

    def speed(time):
        return w * np.pi / 2 * np.sin(np.pi * time * w / 150)
    def height(time):
        return 75 * (1 - np.cos(np.pi * time * w / 150))

    def course(fall_of_pressure=None):
        parcel = Parcel(bins, 300.0, 1e5, 0.98, speed, 1.0, fall_of_pressure)
        states = parcel.integrate(times)
        excess = np.array([parcel.saturation(y) for y in states]) - 1
        beyond = activated(bins, states)[:, 0]
        peak, when = peak_of(times, excess)
        up, down = np.argmax(beyond), len(beyond) - np.argmax(beyond[::-1])
        return states, {"peak": peak, "time": when, "up": times[up], "down": times[down],
                        "top": np.exp(states[15000, 0]), "most": np.exp(states[:, 0].max()),
                        "radius": np.exp(states[-1, 0]),
                        "t": states[-1, -2], "z": height(times),
                        "excess": excess, "r": np.exp(states[:, 0]),
                        "theta": states[:, -2] * (1e5 / np.exp(states[:, -1])) ** (R_D / C_P)}
    times = np.linspace(0, 300 / w, 30001)
    states, own = course()
    # The model's pressure depends on height alone: that of the way up.
    rising = np.arange(100, 15001, 20)
    profile_of = CubicSpline(np.append(0, height(times[rising])), states[np.append(0, rising), -1],
                             extrapolate=True).derivative()
    given = course(lambda time, _: profile_of(height(time)))[1]
    return own, given


ASCENTS = [(f"{w} m/s", (w, 150 if w < 0.2 else 300, CONTINENTAL, 283.15, 0.98, 1.0))
           for w in (0.1, 0.5, 1.0, 3.0)]
ASCENTS += [(f"{name} {w} m/s", (w, 300, modes, 283.0, 0.97, 0.3))
            for name, modes in (("pristine", PRISTINE), ("polluted", POLLUTED))
            for w in (0.25, 1.0, 4.0)]
ASCENTS += [(f"{name} {w} m/s, accommodation 1", (w, 300, modes, 283.0, 0.97, 1.0))
            for name, modes in (("pristine", PRISTINE), ("polluted", POLLUTED)) for w in (1.0,)]
CYCLES = [(f"up and down {w} m/s, {n} cm-3 of {r} um", (w, n * 1e6, r * 1e-6))
          for w in (1.0, 0.5, 0.002) for n, r in ((50, 0.1), (50, 0.05), (500, 0.1))]


def profile(z, theta, heights):
    return "  profile " + ", ".join(f"{h:g} m {np.interp(h, z, theta):.4f} K" for h in heights)


def write_curves(path):
    with open(path, "w", encoding="utf-8") as file:
        file.write("# Made by configs/scenes/parcel_activation/reference.py --curves\n"
                   "# ascent, m s-1; height, m; supersaturation, %; droplets, cm-3\n")
        for _, case in ASCENTS[:4]:
            made = ascend(*case)
            for z in (*range(30, 60, 2), *range(60, 80, 5), *range(80, case[1] + 1, 10)):
                excess = np.interp(z, made["z"], made["excess"])
                number = np.interp(z, made["z"], made["numbers"])
                file.write(f"{case[0]:g} {z} {100 * excess:.5f} {1e-6 * number:.2f}\n")


def main(words):
    for name, case in ASCENTS:
        if words and not any(word in name for word in words):
            continue
        made = ascend(*case)
        print(f"{name}: S_max {100 * made['peak']:.5f} % at {made['time']:.1f} s; activated "
              f"{1e-6 * made['critical']:.2f}, at the end {1e-6 * made['end']:.2f}, most "
              f"{1e-6 * made['most']:.2f} cm-3; liquid {1e3 * made['liquid']:.5f} g/kg, "
              f"{made['t']:.5f} K")
        base = made["z"][np.argmax(made["excess"] > 0)]
        top = made["z"][-1]
        heights = [0, base] + list(base + (top - base) * np.array([.06, .15, .3, .6, 1]))
        print(profile(made["z"], made["theta"], np.round(heights, 1)), flush=True)
    for name, case in CYCLES:
        if words and not any(word in name for word in words):
            continue
        own, made = up_and_down(*case)
        for pressure, run in (("its own pressure", own), ("pressure of the way up", made)):
            print(f"{name}, {pressure}: S_max {100 * run['peak']:.5f} % at {run['time']:.1f} s; "
                  f"activated at {run['up']:.1f} s, haze again at {run['down']:.1f} s; radius "
                  f"{1e6 * run['top']:.5f} um at the top, {1e6 * run['most']:.5f} um at most, "
                  f"{1e6 * run['radius']:.6f} um and {run['t']:.6f} K at the end")
        half = len(made["z"]) // 2 + 1
        base = made["z"][np.argmax(made["excess"] > 0)]
        heights = [0, base] + list(base + (150 - base) * np.array([.06, .12, .2, .3, .5, .75, 1]))
        print(profile(made["z"][:half], made["theta"][:half], np.round(heights, 1)), flush=True)


if __name__ == "__main__":
    if sys.argv[1:2] == ["--curves"]:
        write_curves(sys.argv[2])
    else:
        main([word for word in sys.argv[1:] if word != "--table"])
