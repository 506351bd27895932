// engine/scene/light/packet/facet_kernel.h — a shining surface as many points see it, for compilers to vectorise.
//
// Only a file for each level includes this (.ci/rooms.cmake), compiled for its own instructions, so what it
// defines must not be shared with code for other machines: everything here is a template over the packs' Abi, and
// inlined.
#pragma once
#include "engine/base/pack.h"
#include "engine/scene/light/packet/facet_kernels.h"

namespace lensproof::scene {

template <class Abi>
[[gnu::flatten]] void see_facets(const ShiningFacets& facets, ViewColumns& columns) {
    using Numbers = Pack<double, Abi>;
    const auto load = [](const ViewColumns::Column& column, std::size_t i) { return Numbers::load(column.data() + i); };
    const auto store = [](const Vec3<Numbers>& vector, ViewColumns::Vectors& to, std::size_t i) {
        vector.x.store(to.x.data() + i);
        vector.y.store(to.y.data() + i);
        vector.z.store(to.z.data() + i);
    };
    for (std::size_t i = 0; i < columns.size; i += Numbers::kLanes) {
        const ShiningView<Numbers> seen =
            seen_from<Numbers>({load(columns.from.x, i), load(columns.from.y, i), load(columns.from.z, i)},
                               point_on<Numbers>(facets, load(columns.u1, i), load(columns.u2, i)));
        store(seen.direction, columns.direction, i);
        store(seen.end, columns.end, i);
        seen.cosine.store(columns.cosine.data() + i);
        seen.pdf.store(columns.pdf.data() + i);
        seen.per_pdf.store(columns.per_pdf.data() + i);
    }
}

template <>
FacetKernels facet_kernels_at<SimdLevel::LENSPROOF_LEVEL>() {
    return {.see = see_facets<AbiOf<SimdLevel::LENSPROOF_LEVEL, double>>};
}

}  // namespace lensproof::scene
