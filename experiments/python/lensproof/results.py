"""What the commands find, as objects. Names carry their units as the JSON's keys do; what does not exist is NaN."""
from __future__ import annotations

from dataclasses import dataclass
from typing import Dict, Optional, Tuple

import numpy as np

from ._typed import Result


@dataclass(frozen=True)
class Finding:
    """Something worth saying about a prescription."""

    code: str
    severity: str
    surface: Optional[int]
    message: str
    value: float
    limit: float
    unit: str


@dataclass(frozen=True)
class CheckedLens:
    lens: str
    file: str
    ok: bool
    findings: Tuple[Finding, ...]


@dataclass(frozen=True)
class Check(Result):
    """Of `check`."""

    lenses: Tuple[CheckedLens, ...]


@dataclass(frozen=True)
class Paraxial:
    """First-order data at the reference wavelength."""

    efl_mm: float
    bfl_mm: float
    ffl_mm: float
    entrance_pupil_z_mm: float
    entrance_pupil_diameter_mm: float
    exit_pupil_z_mm: float
    exit_pupil_diameter_mm: float
    f_number: float
    front_principal_z_mm: float
    rear_principal_z_mm: float
    petzval_radius_mm: float
    total_track_mm: float
    lagrange_invariant_mm: float
    image_plane_mm: float
    image_distance_mm: float
    magnification: float
    working_f_number: float
    real_working_f_number: float


@dataclass(frozen=True)
class SeidelSums:
    """Welford's sums, mm; a number, or an array with an entry a surface."""

    s1: float
    s2: float
    s3: float
    s4: float
    s5: float
    c1: float
    c2: float


@dataclass(frozen=True)
class SeidelColumns:
    surface: np.ndarray
    s1: np.ndarray
    s2: np.ndarray
    s3: np.ndarray
    s4: np.ndarray
    s5: np.ndarray
    c1: np.ndarray
    c2: np.ndarray


@dataclass(frozen=True)
class Seidel:
    surfaces: SeidelColumns
    total: SeidelSums


@dataclass(frozen=True)
class Fields:
    """Columns with an entry a field and wavelength."""

    field_deg: np.ndarray
    wavelength_nm: np.ndarray
    status: np.ndarray
    chief_ray_height_mm: np.ndarray
    distortion_percent: np.ndarray
    tangential_focus_mm: np.ndarray
    sagittal_focus_mm: np.ndarray
    relative_illumination: np.ndarray
    vignetting: np.ndarray
    transmittance: np.ndarray
    spot_rms_um: np.ndarray
    spot_centroid_mm: np.ndarray
    wavefront_rms_waves: np.ndarray
    lateral_colour_um: np.ndarray

    def at(self, wavelength_nm: float) -> "Fields":
        """Those of one wavelength."""
        mask = self.wavelength_nm == wavelength_nm
        return Fields(**{name: column[mask] for name, column in vars(self).items()})


@dataclass(frozen=True)
class Analysis(Result):
    """Of `analyze`."""

    lens: str
    name: str
    reference_wavelength_nm: float
    object_distance_mm: float
    projection: str
    findings: Tuple[Finding, ...]
    paraxial: Paraxial
    seidel: Optional[Seidel]
    fields: Fields

    def plot(self, axes=None):
        """Distortion, foci, light and spots over the field at the reference wavelength; four axes."""
        from .plots import plot_analysis

        return plot_analysis(self, axes)


@dataclass(frozen=True)
class GhostParaxial:
    marginal_ray_height_mm: float
    chief_ray_height_mm: float
    efl_mm: float
    focus_mm: float
    pupil_mm: float
    f_number: float


@dataclass(frozen=True)
class Ghost:
    """Light that surfaces reflect on its way, in the order of `surfaces`."""

    surfaces: Tuple[object, ...]
    paraxial: Optional[GhostParaxial]
    energy: float
    energy_standard_error: float
    centroid_mm: np.ndarray
    rms_radius_mm: float
    peak_over_image: float
    landed_share: float


@dataclass(frozen=True)
class GhostSurfaces:
    """What each surface has to do with the ghosts: columns, that with the largest part first."""

    surface: np.ndarray
    share: np.ndarray
    gone_if_perfect: np.ndarray
    gone_if_mgf2: np.ndarray


@dataclass(frozen=True)
class Ghosts(Result):
    """Of `ghosts`; the strongest first."""

    lens: str
    reference_wavelength_nm: float
    source_deg: float
    image_circle_mm: float
    ghosts: Tuple[Ghost, ...]
    surfaces: GhostSurfaces
    energy: float
    image_energy: float
    skipped_energy_bound: float

    def plot(self, axes=None, strongest=12):
        """The strongest ghosts' energies, and their sizes on the sensor."""
        from .plots import plot_ghosts

        return plot_ghosts(self, axes, strongest)


@dataclass(frozen=True)
class Curve:
    """A measured curve over the image height (a share of the half-diagonal), with its 95 % bounds."""

    covered_image_height: float
    image_height: np.ndarray
    value: np.ndarray
    lower_95: np.ndarray
    upper_95: np.ndarray


@dataclass(frozen=True)
class Estimate:
    value: float
    standard_error: float


@dataclass(frozen=True)
class CameraModel:
    kind: str
    parameters: Dict[str, Estimate]


@dataclass(frozen=True)
class Profile(Result):
    """Of `measure`: what pictures of a chart say of a lens."""

    name: str
    image_size_px: Tuple[int, ...]
    pixel_pitch_um: float
    half_diagonal_px: float
    model: CameraModel
    focal_length_px: float
    reprojection_rms_px: float
    views_used: int
    points_used: int
    covered_image_height: float
    curves: Dict[str, Curve]

    def save(self, file):
        """Writes the profile, as the command line's --json would."""
        with open(file, "wb") as stream:
            stream.write(self.json)

    def plot(self, curves=("distortion_percent",), axes=None):
        """Curves by their names, with their 95 % bounds."""
        from .plots import plot_curves

        return plot_curves(self.curves, curves, axes)


@dataclass(frozen=True)
class Difference:
    """How far two differ: `curves` of a comparison has it over the image height."""

    image_height: np.ndarray
    difference: np.ndarray
    lower_95: np.ndarray
    upper_95: np.ndarray


@dataclass(frozen=True)
class ComparisonCheck:
    quantity: str
    value: float
    limit: float
    verdict: str


@dataclass(frozen=True)
class Comparison(Result):
    """Of `compare` with two profiles, a lens and a profile, or two pictures. Numbers of pictures are NaN of others."""

    a: str
    b: str
    curves: Dict[str, Difference]
    checks: Tuple[ComparisonCheck, ...]
    psnr_db: float
    ssim: float
    flip: float
    ciede2000_mean: float
    ciede2000_p99: float

    def plot(self, curves=None, axes=None):
        """The curves' differences, or those named."""
        from .plots import plot_curves

        return plot_curves(self.curves, curves or tuple(self.curves), axes, value="difference")


@dataclass(frozen=True)
class MeasuredLens:
    """Photographs' side of a comparison."""

    source: str
    maker: str
    model: str
    crop_factor: float
    projection: str


@dataclass(frozen=True)
class MeasuredDistortion:
    """Columns are image height (a share of the half-diagonal) and percent."""

    residual_rms_um: float
    residual_largest_um: float
    scale: float
    half_diagonal_mm: float
    measured_percent: np.ndarray
    simulated_percent: np.ndarray
    limit_um: float
    verdict: str


@dataclass(frozen=True)
class MeasuredComparison(Result):
    """Of `compare` with `measured`: a lens and photographs of its product."""

    lens: str
    measured: MeasuredLens
    distortion: MeasuredDistortion

    def plot(self, axes=None):
        """Both distortions over the image height."""
        from .plots import plot_measured

        return plot_measured(self, axes)


@dataclass(frozen=True)
class FitParameter:
    name: str
    value: float
    standard_error: float
    prior_standard_error: float
    determined: bool


@dataclass(frozen=True)
class Undetermined:
    combination: Dict[str, float]
    standard_error: float


@dataclass(frozen=True)
class Fit(Result):
    """Of `fit`."""

    parameters: Tuple[FitParameter, ...]
    undetermined: Tuple[Undetermined, ...]
    residual_rms_um_before: float
    residual_rms_um_after: float
    verdict: str

    def plot(self, axes=None):
        """Each parameter in units of what was expected of it, with its error."""
        from .plots import plot_fit

        return plot_fit(self, axes)


@dataclass(frozen=True)
class Tolerance:
    px: float
    ev: float
    ciede2000: float


@dataclass(frozen=True)
class Effect:
    effect: str
    contribution: Tolerance
    standard_error: Tolerance
    decision: str
    saves_percent: float
    why: str


@dataclass(frozen=True)
class Plan(Result):
    """Of `plan`."""

    tolerance: Tolerance
    model: str
    passes: Tuple[str, ...]
    effects: Tuple[Effect, ...]
    probe_seconds: float

    def plot(self, axes=None):
        """What each effect contributes, over what is tolerated."""
        from .plots import plot_plan

        return plot_plan(self, axes)


@dataclass(frozen=True)
class RungError:
    position_rms_um: float
    image_rms_px: float
    exposure_ev: float
    ciede2000_mean: float
    ciede2000_mean_standard_error: float
    flip: float


@dataclass(frozen=True)
class RungCost:
    ns_per_path: float
    seconds: float
    memory_mib: float


@dataclass(frozen=True)
class Rung:
    model: str
    error: RungError
    cost: RungCost
    pareto: bool


@dataclass(frozen=True)
class Tradeoff(Result):
    """Of `tradeoff`."""

    scene: str
    reference: str
    rungs: Tuple[Rung, ...]

    def plot(self, axes=None):
        """Colour error against cost; the Pareto front is drawn through."""
        from .plots import plot_tradeoff

        return plot_tradeoff(self, axes)
