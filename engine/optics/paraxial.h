// engine/optics/paraxial.h — first-order data of a lens at one wavelength.
#pragma once
#include "engine/optics/trace.h"

namespace lensproof {

/// Height (mm) and slope of a paraxial ray.
struct ParaxialRay {
    double height = 0.0;
    double slope = 0.0;
};

/// Gaussian optics of a lens in air (Welford, Aberrations of Optical Systems, ch. 3); mm.
struct ParaxialData {
    double efl = 0.0;                      // effective focal length, positive for a camera lens
    double bfl = 0.0;                      // last vertex to rear focal point
    double ffl = 0.0;                      // first vertex to front focal point, negative in front of it
    double entrance_pupil_z = 0.0;         // from the first vertex
    double entrance_pupil_diameter = 0.0;  // image of the whole stop
    double exit_pupil_z = 0.0;             // from the last vertex
    double exit_pupil_diameter = 0.0;
    double f_number = 0.0;  // efl / entrance_pupil_diameter
};

/// A paraxial ray that stands at surface `first` (just before it) and is followed to just behind surface `last`;
/// surfaces are counted from 0. With last < first it is followed backwards, from just behind `first` to just before
/// `last`.
ParaxialRay trace_paraxial(const TraceLens<double>& lens, ParaxialRay ray, int first, int last);

/// The lens's first-order data; the stop's opening is its semi-diameter. An afocal lens has an infinite efl.
ParaxialData paraxial_data(const TraceLens<double>& lens);

/// Distance from the last vertex to the paraxial image of an object `object_distance` mm in front of the first vertex.
double paraxial_image_distance(const TraceLens<double>& lens, double object_distance);

}  // namespace lensproof
