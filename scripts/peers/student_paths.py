#!/usr/bin/env python3
"""A path tracer as a student writes it: plain Python and NumPy, all pixels at a time.

    volref export SCENE --to bundle -o DIR         # SCENE.json, and grids beside it
    student_paths.py DIR/SCENE.json OUTPUT         # OUTPUT: .exr, with its noise; .npy or .pfm
    volref validate smoke --serve 'student_paths.py --serve {export:bundle} {spp} {seed}'

All that it knows of a scene stands in the bundle. It renders media in spheres and boxes, of one density or of a
grid, that scatter by Henyey and Greenstein's function, diffuse spheres, boxes and rectangles, and lights of every kind;
the rest it refuses by name. Vectors of n paths have the shape (3, n), numbers of them (n,).
"""

import json
import sys
from pathlib import Path

import numpy as np
from image_file import write_channels, write_image
from student import Field, box_span, column, command, dot, into, length, rays_of, read_floats

MISTAKES = {
    "isotropic": "scatters in all directions alike",
    "no-absorption": "scatters what media should absorb",
    "no-distance": "lets light of a point arrive undiminished by its distance",
    "lamps-twice": "counts lamps when it samples them, and again when it hits them",
}
mistake = None  # the one to be made
random = None  # generator of random numbers
NUMBERS = {"sphere": ["centre", "radius"], "box": ["min", "max"], "rectangle": ["corner", "edge_u", "edge_v"]}
TINY = 1e-300  # in place of a divisor of 0


def refuse(reason):
    sys.exit(f"refused: {reason}")


def cross(a, b):
    return np.cross(a, b, axis=0)


def sphere(z, turn):
    """Directions by their third component and the share of a turn about it."""
    around, r = 2 * np.pi * turn, np.sqrt(1 - z * z)
    return np.array([r * np.cos(around), r * np.sin(around), z])


def turned(local, axis):
    """Directions whose third component is along `axis`."""
    u = cross(axis, np.where(abs(axis[0]) < 0.5, column([1, 0, 0]), column([0, 1, 0])))
    u /= length(u)
    return local[0] * u + local[1] * cross(axis, u) + local[2] * axis


class Shape:
    """A sphere, box or rectangle: rays are taken to where it has its numbers, t stays what it is."""

    def __init__(self, part, key):
        self.part, form = part, part["shape"] or refuse(f"{key}: a medium that fills all space")
        self.kind = form["kind"]
        if self.kind not in NUMBERS:
            refuse(f"{key}: a {self.kind}")
        self.inverse, self.offset = into({"matrix": part["matrix"]} if part["matrix"] else {})
        numbers = [form[name] for name in NUMBERS[self.kind]]
        self.form = [column(number) if isinstance(number, list) else number for number in numbers]
        if self.kind == "rectangle":
            self.form.append(cross(*self.form[1:]))  # to the front, as long as the area

    def span(self, origins, directions):
        """Where rays enter and leave; those that miss it leave before they enter."""
        o, d = self.inverse @ (origins - self.offset), self.inverse @ directions
        with np.errstate(divide="ignore", invalid="ignore"):
            if self.kind == "box":
                return box_span([corner.ravel() for corner in self.form], o, d)
            if self.kind == "sphere":
                centre, radius = self.form
                middle = dot(centre - o, d) / dot(d, d)
                off = o + middle * d - centre
                half = np.sqrt((radius**2 - dot(off, off)) / dot(d, d))
                return np.nan_to_num(middle - half, nan=np.inf), np.nan_to_num(middle + half, nan=-np.inf)
            corner, u, v, normal = self.form
            t = dot(corner - o, normal) / dot(d, normal)
            at = cross(o + t * d - corner, normal)
            inside = (-dot(at, v) >= 0) & (-dot(at, v) <= dot(normal, normal))
            inside &= (dot(at, u) >= 0) & (dot(at, u) <= dot(normal, normal))
            return np.where(inside, t, np.inf), np.where(inside, t, -np.inf)

    def hit(self, origins, directions, least):
        near, far = self.span(origins, directions)
        t = np.where(near > least, near, np.where(far > least, far, np.inf))
        return np.where(near <= far, t, np.inf)

    def normal(self, points):
        """To the front."""
        q = self.inverse @ (points - self.offset)
        if self.kind == "rectangle":
            outward = self.form[3] + 0 * q
        elif self.kind == "sphere":
            outward = q - self.form[0]
        else:
            low, high = self.form
            at = (2 * q - low - high) / np.maximum(high - low, TINY)
            outward = np.where(at < 0, -1, 1) * (np.arange(3)[:, None] == abs(at).argmax(0))
        outward = self.inverse.T @ outward
        return outward / length(outward)


class Lamp(Shape):
    def points(self, count):
        """Spread evenly over it."""
        u, v = random.random((2, count))
        if self.kind == "rectangle":
            return self.form[0] + self.form[1] * u + self.form[2] * v
        return self.form[0] + self.form[1] * sphere(2 * u - 1, v)

    def light(self, points, far, directions):
        """Radiance towards where rays come from, and the density per steradian with which `points` are drawn."""
        area = length(self.form[3])[0] if self.kind == "rectangle" else 4 * np.pi * self.form[1] ** 2
        cosine = -dot(self.normal(points), directions)
        cosine = abs(cosine) if self.part["sides"] == "both" else cosine.clip(0)
        return column(self.part["radiance"]) * (cosine > 0), far**2 / (area * np.maximum(cosine, TINY))


class Surface(Shape):
    def scatter(self, points, before):
        """New directions, the density of a direction, and the share of light that goes on."""
        normal = self.normal(points)
        normal = np.where(dot(normal, before) > 0, -normal, normal)
        u, turn = random.random((2, points.shape[1]))
        after, share = turned(sphere(np.sqrt(u), turn), normal), column(self.part["reflectance"])
        return after, lambda v: dot(normal, v).clip(0) / np.pi, share


class Medium(Shape):
    def __init__(self, part, key, folder):
        super().__init__(part, key)
        self.absorbs, self.scatters, self.emits = (column(part[k]) for k in ("sigma_a", "sigma_s", "emission"))
        if mistake == "no-absorption":
            self.scatters, self.absorbs = self.scatters + self.absorbs, 0 * self.absorbs
        self.extinguishes = self.absorbs + self.scatters
        if part["phase"]["kind"] != "henyey-greenstein":
            refuse(f"{key}.phase: {part['phase']['kind']}")
        self.g = 0 if mistake == "isotropic" else part["phase"]["g"]
        density, self.field = part["density"] or {"kind": "constant", "value": 1.0}, None
        if density["kind"] == "grid":
            values = read_floats(folder / density["file"], -1)
            self.box, self.most = (column(density["box_min"]), column(density["box_max"])), values.max()
            self.field = Field(density, density["interpolation"]["method"], values)
        elif density["kind"] == "constant":
            self.most = density["value"]
        else:
            refuse(f"{key}.density: {density['kind']}")
        self.majorant = max(self.extinguishes.max(), self.emits.max() > 0) * self.most

    def density(self, points, near, far, t):
        """At points a distance t along rays that are in its shape from near to far."""
        inside = (near <= t) & (t <= far)
        if self.field is None:
            return self.most * inside
        q = self.inverse @ (points - self.offset)
        inside &= ((q >= self.box[0]) & (q <= self.box[1])).all(0)
        values = np.zeros(len(t))
        values[inside] = self.field.at(q[:, inside])
        return values

    def phase(self, c):
        return (1 - self.g**2) / (4 * np.pi * (1 + self.g**2 - 2 * self.g * c) ** 1.5)

    def scatter(self, points, before):
        u, turn = random.random((2, points.shape[1]))
        c = 2 * u - 1
        if self.g:
            c = (1 + self.g**2 - ((1 - self.g**2) / (1 - self.g + 2 * self.g * u)) ** 2) / (2 * self.g)
        return turned(sphere(c.clip(-1, 1), turn), before), lambda v: self.phase(dot(before, v)), 1


class Tracer:
    def __init__(self, panel, folder):
        for i, part in enumerate(panel["surfaces"]):
            if part["material"] != "diffuse":
                refuse(f"surfaces[{i}]: {part['material']}")
        named = lambda key: [(part, f"{key}[{i}]") for i, part in enumerate(panel[key])]
        self.surfaces = [Surface(*it) for it in named("surfaces")] + [Lamp(*it) for it in named("area_lights")]
        self.lamps = [it for it in self.surfaces if isinstance(it, Lamp)]
        self.media = [Medium(*it, folder) for it in named("media")]
        self.lights, self.environment = panel["lights"], column(panel["environment"])
        self.suns = [light for light in self.lights if light["kind"] == "directional"]
        self.most = panel["scattering"]["most"]
        # How far a ray leaves the surface on which it begins.
        forms = [np.abs(value).max() for it in self.surfaces for value in [*it.form[:3], it.offset]]
        self.least = 1e-11 * max([*forms, *np.abs(panel["ray"]["eye"])])

    def spans(self, o, d, end):
        """Of each medium on each ray; where the first begins and the last ends; the majorant of all."""
        spans = [medium.span(o, d) for medium in self.media]
        spans = [(near.clip(0), np.minimum(far, end)) for near, far in spans]
        first, last = np.full(o.shape[1], np.inf), np.full(o.shape[1], -np.inf)
        majorant = np.zeros(o.shape[1])
        for medium, (near, far) in zip(self.media, spans):
            inside = near < far
            first, last = np.where(inside & (near < first), near, first), np.where(inside & (far > last), far, last)
            majorant += medium.majorant * inside
        return spans, first, last, majorant

    def transmittance(self, o, d, end):
        """Closed forms where the density is one number, else ratio tracking; 0 behind a surface."""
        clear = np.ones(o.shape[1], bool)
        for surface in self.surfaces:
            clear &= surface.hit(o, d, self.least) >= end * (1 - 1e-9) - self.least
        share = np.ones((3, o.shape[1])) * clear
        for medium, (near, far) in zip(self.media, self.spans(o, d, end)[0]):
            if medium.field is None:
                share *= np.exp(-medium.extinguishes * medium.most * (far - near).clip(0))
                continue
            t, on = near.copy(), np.flatnonzero((near < far) & clear & (medium.majorant > 0))
            while len(on):
                t[on] -= np.log1p(-random.random(len(on))) / medium.majorant
                on = on[t[on] < far[on]]
                density = medium.density(o[:, on] + t[on] * d[:, on], near[on], far[on], t[on])
                share[:, on] *= 1 - medium.extinguishes * density / medium.majorant
        return share

    def from_light(self, light, points):
        """Direction and irradiance of a point, spot or directional light, its shadow included."""
        if light["kind"] == "directional":
            towards, far = -column(light["direction"]) + 0 * points, np.full(points.shape[1], np.inf)
            return towards, column(light["irradiance"]) * self.transmittance(points, towards, far)
        way = column(light["position"]) - points
        far = length(way)
        share = 1 / (1 if mistake == "no-distance" else far**2)
        if light["kind"] == "spot":
            axis, (inner, outer) = column(light["axis"]), (light["inner"], light["outer"])
            angle = np.arctan2(length(cross(way, axis)), -dot(way, axis))
            edge = ((outer - angle) / max(outer - inner, TINY)).clip(0, 1)
            share = share * np.where(angle <= inner, angle < outer, edge)
        return way / far, column(light["intensity"]) * share * self.transmittance(points, way / far, far)

    def direct(self, points, density, lights):
        """Light of `lights` and lamps, times the density with which it is scattered."""
        total = np.zeros(points.shape)
        for light in lights:
            towards, irradiance = self.from_light(light, points)
            total += density(towards) * irradiance
        for lamp in self.lamps:
            at = lamp.points(points.shape[1])
            far = length(at - points)
            towards = (at - points) / far
            radiance, drawn = lamp.light(at, far, towards)
            weight = 1 if mistake == "lamps-twice" else 1 / (1 + (density(towards) / drawn) ** 2)
            total += density(towards) * weight / drawn * radiance * self.transmittance(points, towards, far)
        return total

    def airlight(self, o, d, end):
        """Light of points and spots, scattered into rays at places spread evenly over the angle that lights see."""
        total = np.zeros(o.shape)
        spans, first, last, _ = self.spans(o, d, end)
        on = np.flatnonzero(first < last)
        o, d, first, last = o[:, on], d[:, on], first[on], last[on]
        for light in self.lights if len(on) else []:
            if light["kind"] == "directional":
                continue
            foot = dot(column(light["position"]) - o, d)
            off = length(column(light["position"]) - o - foot * d)
            begin, width = np.arctan2(first - foot, off), np.arctan2(last - foot, off)
            width = width - begin
            beyond = off * np.tan(begin + width * random.random(len(on)))
            t, drawn = foot + beyond, off / (width * (off**2 + beyond**2))
            points = o + t * d
            towards, irradiance = self.from_light(light, points)
            seen = self.transmittance(o, d, t) * irradiance / drawn
            for medium, (near, far) in zip(self.media, spans):
                density = medium.density(points, near[on], far[on], t)
                total[:, on] += medium.scatters * density * medium.phase(dot(d, towards)) * seen
        return total

    def collide(self, o, d, end, beta, seen):
        """The medium that scatters each path, -1 for none, and where; `beta` and what is `seen` change."""
        spans, t, last, majorant = self.spans(o, d, end)
        event, on = np.full(len(end), -1), np.flatnonzero(majorant > 0)
        while len(on):
            t[on] -= np.log1p(-random.random(len(on))) / majorant[on]
            on = on[t[on] < last[on]]
            points = o[:, on] + t[on] * d[:, on]
            rates, null = [], majorant[on] + np.zeros((3, len(on)))
            for medium, (near, far) in zip(self.media, spans):
                here = medium.density(points, near[on], far[on], t[on])
                seen[:, on] += beta[:, on] * medium.emits * here / majorant[on]
                rates.append(medium.scatters * here)
                null -= medium.extinguishes * here
            rates = np.array([*rates, null.clip(0)])
            weights = (rates * beta[:, on]).sum(1)
            total, paths = weights.sum(0), np.arange(len(on))
            chosen = (weights.cumsum(0) <= random.random(len(on)) * total).sum(0).clip(0, len(self.media))
            share = total / np.maximum(weights[chosen, paths], TINY)
            beta[:, on] *= rates[chosen, :, paths].T / majorant[on] * share
            scatters = (chosen < len(self.media)) & (total > 0)
            event[on[scatters]] = chosen[scatters]
            on = on[~scatters & (total > 0)]
        return event, t

    def radiance(self, o, d):
        """What one path along each ray brings back."""
        result, beta = np.zeros(d.shape), np.ones(d.shape)
        density, who, bounce = np.full(d.shape[1], np.inf), np.arange(d.shape[1]), 0
        while len(who):
            goes_on, bounce = self.most is None or bounce < self.most, bounce + 1
            ends = np.array([it.hit(o, d, self.least) for it in self.surfaces] + [np.full(len(who), np.inf)])
            target, end, seen = ends.argmin(0), ends.min(0), np.zeros(o.shape)
            target[np.isinf(end)] = len(self.surfaces)
            if goes_on:
                seen += beta * self.airlight(o, d, end)
            event, t = self.collide(o, d, end, beta, seen)
            target[(event >= 0) | (beta.max(0) == 0)] = -1
            seen += beta * self.environment * (target == len(self.surfaces))
            at, keep = o + np.where(event < 0, np.where(np.isinf(end), 0, end), t) * d, np.zeros(len(who), bool)
            paths = [np.flatnonzero(target == i) for i in range(len(self.surfaces))]
            for on, lamp in zip(paths, self.surfaces):
                if isinstance(lamp, Lamp):
                    radiance, drawn = lamp.light(at[:, on], end[on], d[:, on])
                    weight = 1 if mistake == "lamps-twice" else 1 / (1 + (drawn / density[on]) ** 2)
                    seen[:, on] += beta[:, on] * radiance * weight
            paths += [np.flatnonzero(event == i) for i in range(len(self.media))]
            for on, scatterer in zip(paths, self.surfaces + self.media) if goes_on else []:
                if len(on) and not isinstance(scatterer, Lamp):
                    after, per_steradian, share = scatterer.scatter(at[:, on], d[:, on])
                    lights = self.suns if isinstance(scatterer, Medium) else self.lights
                    beta[:, on] *= share
                    seen[:, on] += beta[:, on] * self.direct(at[:, on], per_steradian, lights)
                    d[:, on], density[on], keep[on] = after, per_steradian(after), True
            result[:, who] += seen
            survival = np.minimum(beta.max(0), 1)
            keep &= random.random(len(who)) < survival
            o, d, beta = at[:, keep], d[:, keep], beta[:, keep] / survival[keep]
            density, who = density[keep], who[keep]
        return result


def render(path, output, options):
    """One path through each pixel at a time; their means, and how much those are off."""
    global mistake, random
    mistake = options["mistake"]
    bundle = json.loads(path.read_text("utf-8"))
    panel = bundle["panels"][0]
    if bundle["schema"] != "volref/bundle/1" or len(bundle["panels"]) > 1:
        refuse("several panels, or a bundle that this renderer does not know")
    if panel["shows"] != "radiance":
        refuse(f"a panel that shows {panel['shows']}")
    count = max(2, options.get("spp") or (panel["samples"] or {}).get("per_pixel", 64))
    random = np.random.default_rng(options.get("seed") or 0)
    tracer, mean, squares = Tracer(panel, path.parent), 0, 0
    for taken in range(1, count + 1):
        shift = random.random((2, panel["width"] * panel["height"])) - 0.5
        eye, directions = rays_of(panel, shift if panel["pixel"]["filter"] == "box" else 0)
        sample = tracer.radiance(eye + 0 * directions, directions)
        off = sample - mean
        mean = mean + off / taken
        squares = squares + off * (sample - mean)
    image, noise = (it.T.reshape(panel["height"], panel["width"], 3) for it in (mean, squares / (count - 1) / count))
    if output.suffix == ".exr" and noise.any():
        planes = np.concatenate([image, noise, np.full_like(image[..., :1], count)], axis=2).transpose(2, 0, 1)
        write_channels(output, dict(zip([*"RGB", "variance.R", "variance.G", "variance.B", "samples.Y"], planes)))
    else:
        write_image(output, image)


if __name__ == "__main__":
    command(render, __doc__, MISTAKES, ("spp", "samples per pixel [the scene's]"), ("seed", "of the random numbers"))
