"""Rays through a lens with all of mpmath's digits: points, directions, optical paths, chief rays, Coddington foci.

Written from the equations alone: the surface as the zero of F(p), Snell's law for the unit normal ∇F / |∇F|, the
Coddington equations in vergences (Welford, Aberrations of Optical Systems, §4.3 and §9.4).
"""
from dataclasses import dataclass

from mpmath import mp, mpf


def dot(a, b):
    return sum(x * y for x, y in zip(a, b))


def along(p, s, d):
    return [x + s * y for x, y in zip(p, d)]


def unit(v):
    length = mp.sqrt(dot(v, v))
    return [x / length for x in v]


def profile(surface, r2):
    """g, dg/d(r²) and d²g/d(r²)² of the sag over r²; None where there is no surface."""
    c, k = surface.c, surface.k
    under = 1 - (1 + k) * c * c * r2
    if under <= 0:
        return None
    root = mp.sqrt(under)
    g, g1, g2 = c * r2 / (1 + root), c / (2 * root), (1 + k) * c ** 3 / (4 * root ** 3)
    r = mp.sqrt(r2)
    for power, a in surface.asphere:
        i = mpf(power) / 2
        g += a * r ** power
        g1 += i * a * r ** (power - 2) if r > 0 or power >= 2 else 0
        g2 += i * (i - 1) * a * r ** (power - 4) if r > 0 or power >= 4 else 0  # of r³ times r² it is 0 on the axis
    return g, g1, g2


def meet_conic(surface, p, d, heading):
    """Path to the conic part, on its vertex's sheet, crossed the way the light is heading; None for a miss."""
    c, k = surface.c, surface.k
    a = c * (dot(d, d) + k * d[2] ** 2)
    b = c * (dot(p, d) + k * p[2] * d[2]) - d[2]  # half of the linear term
    f = c * (dot(p, p) + k * p[2] ** 2) - 2 * p[2]
    if a == 0:
        roots = [-f / (2 * b)] if b != 0 else []
    else:
        discriminant = b * b - a * f
        if discriminant <= 0:
            return None
        root = mp.sqrt(discriminant)
        roots = [(-b + root) / a, (-b - root) / a]
    for s in roots:
        q = along(p, s, d)
        gradient_z = 1 - c * (1 + k) * q[2]
        if gradient_z > 0 and heading * (-c * (q[0] * d[0] + q[1] * d[1]) + gradient_z * d[2]) > 0:
            return s
    return None


def meet(surface, p, d, heading):
    """Path to the surface and its unit normal along the light there; None for a miss. p is relative to the vertex."""
    s = meet_conic(surface, p, d, heading)
    if not surface.asphere:
        if s is None:
            return None
        q = along(p, s, d)
        gradient = [-surface.c * q[0], -surface.c * q[1], 1 - surface.c * (1 + surface.k) * q[2]]
        return s, [heading * x for x in unit(gradient)]
    if s is None:
        s = -p[2] / d[2]
    for _ in range(200):
        q = along(p, s, d)
        g = profile(surface, q[0] ** 2 + q[1] ** 2)
        if g is None:
            return None
        gradient = [-2 * q[0] * g[1], -2 * q[1] * g[1], mpf(1)]
        step = (q[2] - g[0]) / dot(gradient, d)
        s -= step
        if abs(step) < mpf(10) ** (5 - mp.dps):
            break
    else:
        return None
    return (s, [heading * x for x in unit(gradient)]) if heading * dot(gradient, d) > 0 else None


@dataclass
class Hit:
    """A surface that a ray reached. `d` is the direction after it; path = Σ n s from the ray's start."""
    p: list
    d: list
    path: mpf
    s: mpf  # geometrical way from the last point
    n_before: mpf
    n_after: mpf
    cos_in: mpf
    cos_out: mpf
    index: int


@dataclass
class Traced:
    hits: list
    status: str  # ok, missed, total-internal-reflection
    clipped: int | None  # the first surface, from 0, that is met beyond its rim

    @property
    def last(self):
        return self.hits[-1]


def trace(surfaces, p, d, heading=1):
    """Follows a ray beyond rims, forward (heading 1) or in reverse (−1). d is made a unit vector first."""
    d = unit([mpf(x) for x in d])
    p = [mpf(x) for x in p]
    hits, path, clipped = [], mpf(0), None
    for i in range(len(surfaces)) if heading > 0 else reversed(range(len(surfaces))):
        surface = surfaces[i]
        n, n2 = (surface.n_before, surface.n_after)[::heading]
        met = meet(surface, [p[0], p[1], p[2] - surface.z], d, heading)
        if met is None:
            return Traced(hits, "missed", clipped)
        s, normal = met
        p = along(p, s, d)
        path += n * s
        if clipped is None and p[0] ** 2 + p[1] ** 2 > surface.semi ** 2:
            clipped = i
        cos_in = dot(d, normal)
        cos2 = 1 - (n / n2) ** 2 * (1 - cos_in ** 2)
        if cos2 <= 0:
            return Traced(hits, "total-internal-reflection", clipped)
        cos_out = mp.sqrt(cos2)
        d = unit([n / n2 * x + (cos_out - n / n2 * cos_in) * y for x, y in zip(d, normal)])
        hits.append(Hit(p, d, path, s, n, n2, cos_in, cos_out, i))
    return Traced(hits, "ok", clipped)


def at_plane(hit, z):
    """Where the ray behind a surface meets the plane at z, in air, and its path up to there."""
    s = (z - hit.p[2]) / hit.d[2]
    return along(hit.p, s, hit.d), hit.path + s


class ChiefAiming:
    """Rays through the centre of the stop, told apart by their angle u with the axis just before the stop."""

    def __init__(self, lens):
        self.lens = lens
        self.front = lens.surfaces[:lens.stop]
        self.centre = [mpf(0), mpf(0), lens.surfaces[lens.stop].z]

    def incoming(self, u):
        """(point, direction towards the lens) in front of it; None where the ray does not get out."""
        out = trace(self.front, self.centre, [mpf(0), -mp.sin(u), -mp.cos(u)], -1)
        if out.status != "ok":
            return None
        return (out.last.p, [-x for x in out.last.d]) if out.hits else (self.centre, [0, mp.sin(u), mp.cos(u)])

    def field(self, u):
        ray = self.incoming(u)
        return None if ray is None else mp.atan2(ray[1][1], ray[1][2])

    def at_field(self, field):
        """The incoming chief ray of the field angle (radians): a march brackets it, the secant rule finishes."""
        if field == 0:
            return self.incoming(mpf(0))
        low, step = mpf(0), mpf(1) / 20
        while step > mpf("1e-9"):
            theta = self.field(low + step)
            if theta is None:
                step /= 2
            elif theta < field:
                low += step
            else:
                break
        else:
            return None
        high = low + step
        u = mp.findroot(lambda x: self.field(x) - field, (low, high), solver="anderson", tol=mpf(10) ** (-2 * mp.dps + 12),
                        maxsteps=200)
        if abs(self.field(u) - field) > mpf(10) ** (8 - mp.dps):
            raise ArithmeticError("chief ray aiming")
        return self.incoming(u)


def coddington(surfaces, traced, wavefront_distance=None):
    """Distances along the ray from the last surface to the tangential and the sagittal focus.

    n' cos² i' / t' = n cos² i / t + (n' cos i' − n cos i) κ_t, and without the squares for s, with the surface's
    principal curvatures κ where the ray meets it. The object is at infinity, or `wavefront_distance` before the first
    surface along the ray. Written for 1/t, so that collimated light is 0.
    """
    vt = vs = mpf(0) if wavefront_distance is None else -1 / mpf(wavefront_distance)
    for k, hit in enumerate(traced.hits):
        surface = surfaces[hit.index]
        if k > 0:
            vt, vs = vt / (1 - hit.s * vt), vs / (1 - hit.s * vs)
        r2 = hit.p[0] ** 2 + hit.p[1] ** 2
        _, g1, g2 = profile(surface, r2)
        slope2 = 4 * r2 * g1 ** 2  # (dg/dr)²
        sagittal = 2 * g1 / mp.sqrt(1 + slope2)
        tangential = (2 * g1 + 4 * r2 * g2) / mp.sqrt(1 + slope2) ** 3
        bend = hit.n_after * hit.cos_out - hit.n_before * hit.cos_in
        vt = (hit.n_before * hit.cos_in ** 2 * vt + bend * tangential) / (hit.n_after * hit.cos_out ** 2)
        vs = (hit.n_before * vs + bend * sagittal) / hit.n_after
    return 1 / vt, 1 / vs


def close_ray_foci(surfaces, p, d, delta=mpf(10) ** -15):
    """The same foci by pairs of rays `delta` on either side of the ray (p, d), of an object at infinity."""
    across = [mpf(0), d[2], -d[1]]
    foci = []
    for offset in (across, [mpf(1), mpf(0), mpf(0)]):
        one, two = (trace(surfaces, along(p, sign * delta, offset), d).last for sign in (1, -1))
        # The midpoint of the common perpendicular of the two rays, as seen along the chief ray.
        chief = trace(surfaces, p, d).last
        gap, turn = [a - b for a, b in zip(one.p, two.p)], [a - b for a, b in zip(one.d, two.d)]
        side = offset if offset is not across else [mpf(0), chief.d[2], -chief.d[1]]
        # Along each ray to the chief ray's point at distance t: offset gap·side + t turn·side − (way difference) = 0.
        shift = dot(gap, side), dot(turn, side)
        foci.append(-shift[0] / shift[1])
    return foci
