"""Areas of beams through all rims, and means over them, by Gauss-Legendre quadrature in float64.

A beam's cross-section is bounded by pieces of smooth curves, one for each rim (or critical angle, or edge of a surface)
that ends rays there. In polar coordinates about a point inside, the boundary is found by bisection to the last bits,
the corners where one piece gives way to the next by searches in azimuth, and each piece is integrated by
Gauss-Legendre rules of rising order until they agree.
"""
import numpy as np

AGREE = 1e-11  # relative, of two successive rules


class Beamlens:
    """The lens in float64, for many rays at once."""

    def __init__(self, lens):
        self.rows = [(float(s.c), float(s.k), [(p, float(a)) for p, a in s.asphere], float(s.z), float(s.semi),
                      float(s.n_before), float(s.n_after)) for s in lens.surfaces]
        self.image_z = float(lens.image_z)

    def trace(self, p, d, heading=1):
        """(end, p, d, path): where each ray ended, 3 i + (0 rim, 1 missed, 2 reflected), or −1; point, direction, Σ n s."""
        p, d = [np.array(x, dtype=float) for x in p], [np.array(x, dtype=float) for x in d]
        end, path = np.full(p[0].shape, -1), np.zeros(p[0].shape)
        indices = range(len(self.rows)) if heading > 0 else reversed(range(len(self.rows)))
        for i in indices:
            c, k, asphere, z, semi, n, n2 = self.rows[i]
            if heading < 0:
                n, n2 = n2, n
            q = [p[0], p[1], p[2] - z]
            # From the point of closest approach to the vertex, so that little cancels.
            t = -sum(a * b for a, b in zip(q, d))
            q = [a + t * b for a, b in zip(q, d)]
            missed, q, s = meet(q, d, c, k, asphere, heading)
            path = path + n * (t + s)
            slope2 = profile(q[0] ** 2 + q[1] ** 2, c, k, asphere)[1] * 2
            normal = [-q[0] * slope2, -q[1] * slope2, np.ones_like(slope2)]
            length = heading / np.sqrt(sum(a * a for a in normal))
            normal = [a * length for a in normal]
            cos_in = sum(a * b for a, b in zip(d, normal))
            cos2 = 1 - (n / n2) ** 2 * (1 - cos_in ** 2)
            with np.errstate(invalid="ignore"):
                for kind, fails in ((1, missed), (0, q[0] ** 2 + q[1] ** 2 > semi ** 2), (2, ~(cos2 > 0))):
                    end = np.where((end < 0) & fails, 3 * i + kind, end)
                turn = np.sqrt(np.where(cos2 > 0, cos2, 1)) - n / n2 * cos_in
            d = [n / n2 * a + turn * b for a, b in zip(d, normal)]
            p = [q[0], q[1], q[2] + z]
            # Rays that have ended go on as something finite.
            dead = end >= 0
            p = [np.where(dead, x, a) for a, x in zip(p, (0, 0, z))]
            d = [np.where(dead, x, a) for a, x in zip(d, (0, 0, heading))]
        return end, p, d, path


def profile(r2, c, k, asphere):
    root = np.sqrt(np.maximum(1 - (1 + k) * c * c * r2, 1e-300))
    g, g1 = c * r2 / (1 + root), c / (2 * root)
    for power, a in asphere:
        i = power / 2 if power % 2 else power // 2
        g = g + a * r2 ** i
        g1 = g1 + i * a * r2 ** (i - 1)
    return g, g1


def meet(q, d, c, k, asphere, heading):
    """(missed, point, way) for rays given at their closest approach to the vertex."""
    a = c * (1 + k * d[2] ** 2)
    b = c * k * q[2] * d[2] - d[2]
    f = c * (q[0] ** 2 + q[1] ** 2 + (1 + k) * q[2] ** 2) - 2 * q[2]
    discriminant = b * b - a * f
    missed = ~(discriminant > 0)
    root = np.sqrt(np.where(missed, 1, discriminant))
    # The slope of the surface's function along the ray is b + a s, here heading · root.
    large = -b + np.where(b > 0, -root, root)
    straight = -b * heading > 0
    with np.errstate(divide="ignore", invalid="ignore"):
        s = np.where(straight, f / large, large / a)
    missed = missed | ~np.isfinite(s)
    s = np.where(missed, 0, s)
    at = [x + s * y for x, y in zip(q, d)]
    missed = missed | ~(1 - c * (1 + k) * at[2] > 0)
    if asphere:
        for _ in range(60):  # steps of 1 mm at most keep lost rays finite
            g, g1 = profile(at[0] ** 2 + at[1] ** 2, c, k, asphere)
            rise = d[2] - 2 * g1 * (at[0] * d[0] + at[1] * d[1])
            step = np.clip((at[2] - g) / np.where(rise * heading > 0, rise, heading), -1, 1)
            at, s = [x - step * y for x, y in zip(at, d)], s - step
        missed = missed | ~(np.abs(step) < 1e-9)
    return missed, [np.where(missed, 0, x) for x in at], np.where(missed, 0, s)


class Region:
    """The set of (a, b) whose ray passes: `rays(a, b)` gives start and direction; looked for within the `extents`."""

    def __init__(self, beam, rays, heading, extents):
        self.beam, self.rays, self.heading = beam, rays, heading
        self.centre = self.find_centre(extents)
        if self.centre is not None:
            self.corners = self.find_corners()

    def end(self, a, b):
        return self.beam.trace(*self.rays(a, b), self.heading)[0]

    def find_centre(self, extents):
        """The mean of the passing rays of a grid, ever wider and finer; None where no light passes."""
        for extent in extents:
            for cells in (64, 512):
                self.radius = 2 * extent
                grid = extent * ((np.arange(cells) + 0.5) / cells * 2 - 1)
                a, b = (x.ravel() for x in np.meshgrid(grid, grid))
                inside = self.end(a, b) < 0
                if inside.sum() > 30:
                    return 0.0, b[inside].mean()
        return None

    def edge(self, azimuth):
        """(radius, what ends rays just beyond) along each azimuth."""
        azimuth = np.asarray(azimuth, dtype=float)
        ca, sa = np.cos(azimuth), np.sin(azimuth)
        low, high = np.zeros_like(azimuth), np.full_like(azimuth, self.radius)
        beyond = np.full(azimuth.shape, -2)
        for _ in range(60):
            middle = 0.5 * (low + high)
            end = self.end(self.centre[0] + middle * ca, self.centre[1] + middle * sa)
            inside = end < 0
            beyond = np.where(inside, beyond, end)
            low, high = np.where(inside, middle, low), np.where(inside, high, middle)
        return 0.5 * (low + high), beyond

    def find_corners(self, first=720):
        """Azimuths in [−π/2, π/2] between which one rim bounds the beam; it is symmetric about the b axis."""
        azimuth = np.linspace(-np.pi / 2, np.pi / 2, first + 1)
        radius, label = self.edge(azimuth)
        self.check_star(azimuth, radius)
        change = np.nonzero(label[1:] != label[:-1])[0]
        low, high, left = azimuth[change], azimuth[change + 1], label[change]
        for _ in range(8):  # 64 parts each: down to the last bits
            if not change.size:
                break
            parts = low[:, None] + (high - low)[:, None] * np.arange(65) / 64
            same = self.edge(parts.ravel())[1].reshape(parts.shape) == left[:, None]
            last = np.argmin(np.concatenate([same, np.zeros((len(low), 1), bool)], axis=1), axis=1) - 1
            rows = np.arange(len(low))
            low, high = parts[rows, last], parts[rows, np.minimum(last + 1, 64)]
        return np.concatenate([[-np.pi / 2], 0.5 * (low + high), [np.pi / 2]])

    def check_star(self, azimuth, radius):
        share = np.linspace(0.02, 0.999999, 60)
        a = self.centre[0] + np.outer(radius * np.cos(azimuth), share)
        b = self.centre[1] + np.outer(radius * np.sin(azimuth), share)
        if (self.end(a.ravel(), b.ravel()) >= 0).any():
            raise ArithmeticError("the beam is not star-shaped about the mean of its rays")

    def rule(self, order):
        """Azimuths and weights over the right half, each piece by a Gauss-Legendre rule."""
        x, w = np.polynomial.legendre.leggauss(order)
        pieces = [(lo, hi) for lo, hi in zip(self.corners[:-1], self.corners[1:]) if hi > lo]
        azimuth = np.concatenate([0.5 * (lo + hi) + 0.5 * (hi - lo) * x for lo, hi in pieces])
        return azimuth, np.concatenate([0.5 * (hi - lo) * w for lo, hi in pieces])

    def refined(self, integral):
        """integral(order of the rule) for rising orders until two agree; (value, relative difference of the two)."""
        last = None
        for order in (16, 32, 64, 128, 256, 512):
            value = np.atleast_1d(integral(order))
            if last is not None:
                error = np.max(np.abs(value - last)) / np.max(np.abs(value))
                if error < AGREE:
                    break
            last = value
        return value, error

    def area(self):
        def half(order):
            azimuth, weight = self.rule(order)
            return np.sum(weight * self.edge(azimuth)[0] ** 2)  # twice the half's ∫ r² / 2
        value, error = self.refined(half)
        return value[0], error

    def means(self, function, order_radial=40):
        """∫ over the region of function(a, b) (rows of values), both halves, by azimuth and radius."""
        nodes, weights = np.polynomial.legendre.leggauss(order_radial)
        nodes, weights = 0.5 * (nodes + 1), 0.5 * weights

        def whole(order):
            azimuth, weight = self.rule(order)
            radius = self.edge(azimuth)[0]
            r = np.outer(radius, nodes)
            measure = np.outer(weight * radius, weights) * r
            total = 0
            for side in (1, -1):
                a = self.centre[0] + side * r * np.cos(azimuth)[:, None]
                b = self.centre[1] + r * np.sin(azimuth)[:, None]
                total = total + np.sum(function(a.ravel(), b.ravel()) * measure.ravel(), axis=1)
            return total
        return self.refined(whole)


def incoming_beam(beam, chief_point, chief_direction):
    """Offsets (a, b) across a collimated beam about its chief ray: a along x, b in the meridional plane."""
    p, d = [float(x) for x in chief_point], [float(x) for x in chief_direction]

    def rays(a, b):
        return ([p[0] + a, p[1] + b * d[2], p[2] - b * d[1]], [np.full_like(a, x) for x in d])
    return rays


def cones_of(beam, image_y):
    """Direction cosines (l, m) = (a, b) of rays from the image point (0, image_y) towards the scene."""
    def rays(a, b):
        n2 = np.maximum(1 - a * a - b * b, 1e-12)  # no such cosines: nearly along the image plane, and stopped there
        return ([np.zeros_like(a), np.full_like(a, image_y), np.full_like(a, beam.image_z)], [a, b, -np.sqrt(n2)])
    return rays


def spot(beam, region, origin_y):
    """Centroid (y) and rms radius over the beam's cross-section, mm, of where rays meet the image plane."""
    rays = region.rays

    def moments(a, b):
        _, p, d, _ = beam.trace(*rays(a, b), 1)
        s = (beam.image_z - p[2]) / d[2]
        x, y = p[0] + s * d[0], p[1] + s * d[1] - origin_y
        return np.array([np.ones_like(x), y, x * x + y * y])
    (area, first, second), error = region.means(moments)
    y = first / area
    return origin_y + y, np.sqrt(max(second / area - y * y, 0.0)), error


def wavefront_rms(beam, region, centre, radius, wavelength_nm):
    """Rms optical path difference, waves, over the beam's cross-section, less the mean.

    Paths are taken up to the sphere of the given centre and radius: from the image point to the exit pupil, positive where
    that lies in front of the image.
    """
    def moments(a, b):
        _, p, d, path = beam.trace(*region.rays(a, b), 1)
        to_centre = [c - x for c, x in zip(centre, p)]
        foot = sum(x * y for x, y in zip(to_centre, d))
        off2 = sum(x * x for x in to_centre) - foot * foot
        waves = (path + foot - np.sign(radius) * np.sqrt(radius * radius - off2)) / (1e-6 * wavelength_nm)
        waves = waves - waves_at_centre[0] if waves_at_centre else waves
        return np.array([np.ones_like(waves), waves, waves * waves])

    waves_at_centre = []
    middle = moments(np.array([region.centre[0]]), np.array([region.centre[1]]))
    waves_at_centre.append(middle[1][0])
    (area, first, second), error = region.means(moments)
    return np.sqrt(max(second / area - (first / area) ** 2, 0.0)), error
