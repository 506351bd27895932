"""First order and third order of a lens, from the paraxial refraction and transfer equations with mpmath's digits."""
from mpmath import mp, mpf


def vertex_curvature(surface):
    return surface.c + 2 * dict(surface.asphere).get(2, mpf(0))


def paraxial(surfaces, y, u):
    """Heights at the surfaces and slopes behind them of the ray that arrives at the first one with y and u = dy/dz."""
    heights, slopes = [], []
    for i, s in enumerate(surfaces):
        if i > 0:
            y += u * (s.z - surfaces[i - 1].z)
        u = (s.n_before * u - y * (s.n_after - s.n_before) * vertex_curvature(s)) / s.n_after
        heights.append(y)
        slopes.append(u)
    return heights, slopes


def to_stop(surfaces, stop, y, u):
    """Height just at the stop and the slope before it of the ray that arrives at the first surface with y and u."""
    for i in range(stop + 1):
        if i > 0:
            y += u * (surfaces[i].z - surfaces[i - 1].z)
        if i < stop:
            s = surfaces[i]
            u = (s.n_before * u - y * (s.n_after - s.n_before) * vertex_curvature(s)) / s.n_after
    return (y,), (u,)


def first_order(lens):
    surfaces, stop = lens.surfaces, lens.stop
    y, u = paraxial(surfaces, mpf(1), mpf(0))
    efl, bfl = -1 / u[-1], -y[-1] / u[-1]
    # The ray that leaves parallel to the axis: a combination of two that span all.
    y0, u0 = paraxial(surfaces, mpf(0), mpf(1))
    a = -u0[-1] / u[-1]  # incoming height for incoming slope 1
    ffl = -a
    # Entrance pupil: incoming rays (height a, slope 1) that meet the axis at the stop.
    (at_stop_parallel,), _ = to_stop(surfaces, stop, mpf(1), mpf(0))
    (at_stop_slope,), _ = to_stop(surfaces, stop, mpf(0), mpf(1))
    chief = -at_stop_slope / at_stop_parallel
    entrance_z = -chief
    entrance_d = 2 * surfaces[stop].semi / at_stop_parallel
    chief_y = chief * y[-1] + y0[-1]
    chief_u = chief * u[-1] + u0[-1]
    exit_z = -chief_y / chief_u
    # The chief ray's slope times the pupil's size is the same on both sides (Lagrange), air on both.
    exit_d = abs(entrance_d / chief_u)
    powers = sum(vertex_curvature(s) * (s.n_after - s.n_before) / (s.n_before * s.n_after) for s in surfaces)
    return {"efl_mm": efl, "bfl_mm": bfl, "ffl_mm": ffl, "entrance_pupil_z_mm": entrance_z,
            "entrance_pupil_diameter_mm": abs(entrance_d), "exit_pupil_z_mm": exit_z, "exit_pupil_diameter_mm": exit_d,
            "f_number": efl / abs(entrance_d), "petzval_radius_mm": -1 / powers}


def delta(a, b):
    return b - a


def seidel(lens, field, index_difference):
    """Welford's sums (Aberrations of Optical Systems, §8.2, §8.6; colour §10.4) for the full stop and the field angle.

    S1 = −A² y Δ(u/n), S2 = −A Ā y Δ(u/n), S3 = −Ā² y Δ(u/n), S4 = −H² c Δ(1/n), S5 = (S3 + S4) Ā / A,
    C1 = A y Δ(δn/n), C2 = Ā y Δ(δn/n), δn = n(short) − n(long); an asphere's term of fourth order beyond its sphere, G r⁴,
    adds 8 G Δn y⁴ to S1, and (ȳ/y) times more for each next one of S2, S3 and S5 (twice), none to S4.
    """
    surfaces = lens.surfaces
    data = first_order(lens)
    h = data["entrance_pupil_diameter_mm"] / 2
    slope = mp.tan(field)
    y, u = paraxial(surfaces, h, mpf(0))
    yb, ub = paraxial(surfaces, -data["entrance_pupil_z_mm"] * slope, slope)
    invariant = h * slope
    rows = []
    for i, s in enumerate(surfaces):
        u_in, ub_in = (u[i - 1], ub[i - 1]) if i else (mpf(0), slope)
        n, n2, c = s.n_before, s.n_after, vertex_curvature(s)
        a, ab = n * (u_in + y[i] * c), n * (ub_in + yb[i] * c)
        bend = delta(u_in / n, u[i] / n2)
        s1, s2, s3 = -a * a * y[i] * bend, -a * ab * y[i] * bend, -ab * ab * y[i] * bend
        s4 = -invariant ** 2 * c * delta(1 / n, 1 / n2)
        s5 = (s3 + s4) * ab / a
        k = 8 * (fourth_order(s) - c ** 3 / 8) * (n2 - n) * y[i] ** 4
        q = yb[i] / y[i]
        dn, dn2 = index_difference(i)
        colour = y[i] * delta(dn / n, dn2 / n2)
        rows.append([s1 + k, s2 + k * q, s3 + k * q ** 2, s4, s5 + k * q ** 3, a * colour, ab * colour])
    return invariant, rows


def fourth_order(s):
    """The coefficient of r⁴ in the sag."""
    return (1 + s.k) * s.c ** 3 / 8 + dict(s.asphere).get(4, mpf(0))
