"""Small drawings of results. Each takes Matplotlib's axes, or makes some, and returns them."""
import itertools

import numpy as np


def _axes(axes, *, rows=1, columns=1, size=(5.0, 3.6)):
    if axes is not None:
        return axes
    from matplotlib import pyplot

    figure, made = pyplot.subplots(rows, columns, figsize=(size[0] * columns, size[1] * rows), layout="constrained")
    return made


def _label(axes, x, y, title=""):
    axes.set_xlabel(x)
    axes.set_ylabel(y)
    axes.set_title(title)
    axes.grid(alpha=0.3)


def plot_analysis(analysis, axes=None):
    axes = _axes(axes, rows=2, columns=2)
    fields = analysis.fields.at(analysis.reference_wavelength_nm)
    if not fields.field_deg.size:  # the reference is none of the wavelengths
        fields = analysis.fields.at(analysis.fields.wavelength_nm[0])
    over = "field (°)"
    distortion, foci, light, spots = np.ravel(axes)
    distortion.plot(fields.field_deg, fields.distortion_percent, marker=".")
    _label(distortion, over, "distortion (%)", analysis.name)
    foci.plot(fields.field_deg, fields.tangential_focus_mm, marker=".", label="tangential")
    foci.plot(fields.field_deg, fields.sagittal_focus_mm, marker=".", label="sagittal")
    foci.legend()
    _label(foci, over, "focus from the image plane (mm)")
    light.plot(fields.field_deg, fields.relative_illumination, marker=".", label="relative illumination")
    light.plot(fields.field_deg, fields.vignetting, marker=".", label="vignetting")
    light.set_ylim(bottom=0.0)
    light.legend()
    _label(light, over, "over the axis")
    spots.plot(fields.field_deg, fields.spot_rms_um, marker=".")
    spots.set_ylim(bottom=0.0)
    _label(spots, over, "spot, rms (µm)")
    return axes


def plot_ghosts(ghosts, axes=None, strongest=12):
    axes = _axes(axes)
    shown = ghosts.ghosts[:strongest]
    names = ["–".join(map(str, ghost.surfaces)) for ghost in shown]
    axes.barh(names, [ghost.energy for ghost in shown], xerr=[ghost.energy_standard_error for ghost in shown])
    axes.invert_yaxis()
    for row, ghost in enumerate(shown):
        axes.annotate(f"  {ghost.rms_radius_mm:.3g} mm", (ghost.energy, row), va="center", fontsize="small")
    axes.set_xlim(0.0, 1.25 * max((ghost.energy for ghost in shown), default=1.0))
    axes.ticklabel_format(axis="x", style="sci", scilimits=(-2, 2))
    _label(axes, "energy on the sensor, of the light that enters", "reflected at surfaces",
           f"{ghosts.lens}, light at {ghosts.source_deg:g}°, with rms radii")
    return axes


def plot_curves(curves, names, axes=None, value="value"):
    axes = _axes(axes)
    names = [names] if isinstance(names, str) else list(names)
    for name in names:
        curve = curves[name]
        (line,) = axes.plot(curve.image_height, getattr(curve, value), label=name)
        axes.fill_between(curve.image_height, curve.lower_95, curve.upper_95, color=line.get_color(), alpha=0.2)
    axes.legend(fontsize="small")
    _label(axes, "image height (half-diagonals)", value if len(names) > 1 else names[0])
    return axes


def plot_measured(comparison, axes=None):
    axes = _axes(axes)
    for name, curve in (("photographed", comparison.distortion.measured_percent),
                        ("simulated", comparison.distortion.simulated_percent)):
        axes.plot(curve[:, 0], curve[:, 1], label=name)
    axes.legend()
    _label(axes, "image height (half-diagonals)", "distortion (%)", f"{comparison.lens}: {comparison.distortion.verdict}")
    return axes


def plot_fit(fit, axes=None):
    axes = _axes(axes)
    names = [parameter.name for parameter in fit.parameters]
    scale = [parameter.prior_standard_error or np.nan for parameter in fit.parameters]
    axes.errorbar([parameter.value / unit for parameter, unit in zip(fit.parameters, scale)], names,
                  xerr=[parameter.standard_error / unit for parameter, unit in zip(fit.parameters, scale)], fmt="o")
    axes.axvline(0.0, color="grey", linewidth=0.8)
    _label(axes, "change, in units of what was expected", "", fit.verdict)
    return axes


def plot_plan(plan, axes=None):
    axes = _axes(axes, size=(6.5, 6.0))
    names = [effect.effect for effect in plan.effects]
    places = np.arange(len(names))
    for offset, unit in ((-0.25, "px"), (0.0, "ev"), (0.25, "ciede2000")):
        tolerated = getattr(plan.tolerance, unit)
        if tolerated > 0.0:
            axes.barh(places + offset, [getattr(effect.contribution, unit) / tolerated for effect in plan.effects], 0.25,
                      label=unit)
    axes.set_yticks(places, names)
    axes.axvline(1.0, color="black", linewidth=0.8)
    axes.invert_yaxis()
    axes.legend()
    _label(axes, "contribution over what is tolerated", "", f"model: {plan.model}")
    return axes


def plot_tradeoff(tradeoff, axes=None):
    axes = _axes(axes, size=(7.0, 4.0))
    for rung, marker in zip(tradeoff.rungs, itertools.cycle("osD^v<>pPX*h")):
        axes.plot(rung.cost.seconds, rung.error.ciede2000_mean, marker, label=rung.model,
                  markerfacecolor=None if rung.pareto else "none")
    front = sorted((rung.cost.seconds, rung.error.ciede2000_mean) for rung in tradeoff.rungs if rung.pareto)
    axes.plot(*zip(*front), color="grey", linewidth=0.8, zorder=0)
    axes.set_xscale("log")
    axes.legend(fontsize="small", loc="center left", bbox_to_anchor=(1.0, 0.5))
    _label(axes, "seconds of one core", "colour error (mean CIEDE2000)", f"reference: {tradeoff.reference}; filled: on the front")
    return axes


def plot_spot(traced, axes=None):
    axes = _axes(axes, size=(4.0, 4.0))
    x, y = traced.at_image()
    middle = np.nanmean(x), np.nanmean(y)
    axes.plot(1000.0 * (x - middle[0]), 1000.0 * (y - middle[1]), ".", markersize=2)
    axes.set_aspect("equal", "datalim")
    _label(axes, "x (µm)", "y (µm)", f"about ({middle[0]:.4g}, {middle[1]:.4g}) mm")
    return axes


def plot_point_image(image, axes=None):
    axes = _axes(axes, size=(4.2, 3.6))
    half = image.half_width_um
    drawn = axes.imshow(image.intensity, origin="lower", extent=(-half, half, -half, half), cmap="magma")
    axes.figure.colorbar(drawn, ax=axes, label="of a perfect lens's peak")
    axes.set_xlabel("x (µm)")
    axes.set_ylabel("y (µm)")
    axes.set_title(f"{image.field_deg:g}°: Strehl ratio {image.strehl:.3g}")
    return axes


def plot_mtf(mtf, axes=None):
    axes = _axes(axes)
    (line,) = axes.plot(mtf.frequency_per_mm, mtf.tangential, label=f"{mtf.field_deg:g}° tangential")
    axes.plot(mtf.frequency_per_mm, mtf.sagittal, "--", color=line.get_color(), label=f"{mtf.field_deg:g}° sagittal")
    if mtf.limit_tangential.size:
        axes.plot(mtf.frequency_per_mm, mtf.limit_tangential, ":", color="grey")
    axes.set_ylim(0.0, 1.0)
    axes.legend(fontsize="small", loc="upper right")
    _label(axes, "cycles/mm", "modulation")
    return axes


def plot_picture(picture, axes=None, exposure_ev=0.0):
    axes = _axes(axes)
    axes.imshow(picture.srgb(exposure_ev))
    axes.set_axis_off()
    return axes
