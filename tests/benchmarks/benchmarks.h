// tests/benchmarks/benchmarks.h — the hot paths, registered with Google Benchmark by name.
#pragma once
#include <string>

namespace lensproof {

/// trace/LENS/DIRECTION/RIMS/TYPE: a bundle that fills the lens, over 70 % of its field, ray by ray.
/// batch/LENS/TYPE/LEVEL/WHAT: the same rays in batches, at every SIMD level of the machine; `geometry` alone, with
/// `fresnel` losses, and with 64 wavelengths side by side. batch/LENS/plain and …/plain_fresnel are what these are
/// judged by: the same physics in a scalar loop over doubles. Counters: rays and ray-surfaces per second.
void register_trace_benchmarks();

/// render/LENS/CHART: camera paths of the chart renderer on one thread (counter: paths per second);
/// pupil_sample/LENS: one point of the pupil.
void register_render_benchmarks();

/// sampler/points/…: 64 points of a pixel, one by one, and in columns with their film positions (counter: points per
/// second). camera_paths/LENS/…: a picture's paths from the film out of the lens, one by one through the scalar tracer,
/// and in buffers at one lane and at the widest level; …/chart looks each up on a chart besides.
/// Counters: valid paths per second, seconds a valid path, and passage.
void register_camera_path_benchmarks();

/// polynomial/LENS/MODEL/…: buffers of camera paths of the exact model and of the polynomial one, which carry their
/// hero alone or are asked for all wavelengths (of which the polynomial one has the hero; counter: seconds a valid
/// path). polynomial/LENS/fit: what polynomials take to find, how many terms of which degree they have, and their
/// error.
void register_polynomial_benchmarks();

/// scene/MODEL: camera paths of up to five bounces through a scene of a checkered wall, a sphere and an area light,
/// with each camera model, the exact one being the double Gauss at f/2; scene/sky/…: the same in the open, under an
/// even sky and under a map of 4096 × 2048 pixels. Counters: paths per second, rays a path.
void register_scene_benchmarks();

/// bsdf/SURFACE/sample: a direction drawn; bsdf/SURFACE/evaluate: value and pdf of a given one; texture/KIND: one
/// look-up at a path's four wavelengths.
void register_bsdf_benchmarks();

/// chief_rays/LENS/…: construction and aiming; refine/CHART: sub-pixel positions of all points of one chart in one
/// channel (counter: points per second).
void register_measure_benchmarks();

/// analyze/LENS/table: all rows of ten fields at three wavelengths; …/curves: fans, field curves, spots through focus
/// and the rest that needs no diffraction. westrogon-24 has 14 surfaces and a stop.
void register_analysis_benchmarks();

/// ghosts/LENS: the picture of all ghosts of two reflections of a distant light, eight wavelengths on 1000 × 1000
/// pixels, by meshes on one thread. Counters: ghosts with more than 1e-6 of the light; the largest of their energies'
/// stated errors; the CPU time of rays at random over the front element, reflected at random, until each such ghost's
/// energy is known to 1 %, by the variance that a part of them shows; and how many times that is the meshes'.
/// double-gauss-angenieux has 14 surfaces and a stop.
void register_ghost_benchmarks();

/// On the GPU, or where there is none, and less of it, on what stands in for one: device/trace/LENS/TYPE/WHAT: four
/// million rays, each of one of four wavelengths, in its memory already. device/chart/MODEL/…: a chart of 720 × 540
/// pixels rendered by all processors alone, and with the device's help. Counters: rays, ray-surfaces, samples a second.
void register_device_benchmarks();

}  // namespace lensproof
