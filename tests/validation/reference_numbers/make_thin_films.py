"""Writes thin_films.csv: what the tmm package (S. J. Byrnes, PyPI, MIT) says of random stacks of thin films.

    python3 -m venv venv && venv/bin/pip install tmm==0.2.0 && venv/bin/python make_thin_films.py > thin_films.csv

A row is a stack at an angle in its first medium: layers as n:k:thickness, with the vacuum wavelength as the unit of
length, then r and t of both polarisations, and R and T. tmm multiplies 2 × 2 matrices of travelling waves, with the
signs of Fresnel's equations in Born & Wolf and e^(-iωt), as the project has them.
"""
import math, random
from tmm import coh_tmm

random.seed(20)


def layer(kind):
    if kind == "metal":
        return random.uniform(0.05, 3.0), random.uniform(1.0, 5.0), random.uniform(0.002, 0.05)
    absorption = random.choice([0.0, random.uniform(0.0, 0.3)])
    return random.uniform(1.05, 3.5), absorption, random.uniform(0.01, 1.0)


print("n1,n2,angle_rad,layers,r_s_re,r_s_im,t_s_re,t_s_im,r_p_re,r_p_im,t_p_re,t_p_im,R_s,T_s,R_p,T_p")
for case in range(120):
    n1, n2 = random.choice([(1.0, 1.52), (1.52, 1.0), (1.0, 1.9), (1.7, 1.5), (1.6, 1.6)])
    layers = [layer(random.choice(["film", "film", "film", "metal"])) for _ in range(random.randint(1, 9))]
    if case % 3 == 0:
        layers = [(n, 0.0, d) for n, k, d in layers if n >= 1.05] or [(1.38, 0.0, 0.18)]
    angle = random.uniform(0.0, 1.5)
    cells = [repr(n1), repr(n2), repr(angle), " ".join(f"{n!r}:{k!r}:{d!r}" for n, k, d in layers)]
    powers = []
    for polarisation in "sp":
        found = coh_tmm(polarisation, [n1] + [complex(n, k) for n, k, _ in layers] + [n2],
                        [math.inf] + [d for _, _, d in layers] + [math.inf], angle, 1.0)
        cells += [repr(float(x)) for a in (found["r"], found["t"]) for x in (a.real, a.imag)]
        powers += [repr(float(found["R"])), repr(float(found["T"]))]
    print(",".join(cells + powers))
