#include "engine/optics/paraxial.h"

namespace lensproof::optics {

template ParaxialRay trace_paraxial(const TraceLens<double>&, ParaxialRay, int, int);
template ParaxialData paraxial_data(const TraceLens<double>&);
template double paraxial_image_distance(const TraceLens<double>&, const double&);
template Conjugates paraxial_conjugates(const TraceLens<double>&, const double&);

}  // namespace lensproof::optics
