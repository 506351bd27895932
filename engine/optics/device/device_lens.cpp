#include "engine/optics/device/device_lens.h"

namespace lensproof::optics {

namespace {

/// Where a special surface's own arrays lie.
template <class T>
struct SpecialPlaces {
    device::ParcelPlace<TraceLayer<T>> layers;
    device::ParcelPlace<StopOpening::Edge> edges;
    device::ParcelPlace<float> texture;
};

template <class T>
SpecialPlaces<T> pack_special(device::Parcel& parcel, const SpecialSurface<T>& special) {
    const StopOpening opening = special.mask.opening();
    return {.layers = parcel.add(special.coating.layers),
            .edges = parcel.add(opening.edges),
            .texture = parcel.add(opening.texture)};
}

template <class T>
typename LensView<T>::Special special_on_device(const device::Parcel& parcel, const SpecialSurface<T>& from,
                                                const SpecialPlaces<T>& places) {
    StopOpening mask = from.mask.opening();
    mask.edges = parcel.span(places.edges);
    mask.texture = parcel.span(places.texture);
    return {.has_shape = from.has_shape,
            .shape = from.shape,
            .vertex = from.vertex,
            .axes = from.axes,
            .coating = {.layers = parcel.span(places.layers),
                        .reflectance = from.coating.reflectance,
                        .is_mirror = from.coating.is_mirror},
            .mask = mask,
            .thin = from.thin};
}

template <class T>
std::vector<typename LensView<T>::Surface> surface_table(const TraceLens<T>& lens) {
    using Entry = typename LensView<T>::Surface;
    std::vector<Entry> table;
    for (const TraceSurface<T>& surface : lens.surfaces) {
        table.push_back({.curvature = surface.curvature,
                         .vertex_z = surface.vertex_z,
                         .semi_diameter_squared = surface.semi_diameter_squared,
                         .special_and_notes = 8 * surface.special + (surface.is_stop ? Entry::kIsStop : 0) +
                                              (surface.from_far_forward ? Entry::kFromFarForward : 0) +
                                              (surface.from_far_reverse ? Entry::kFromFarReverse : 0)});
    }
    return table;
}

}  // namespace

template <class T>
DeviceLens<T>::DeviceLens(const device::Device& device, const SpectralLens<T>& lens) {
    const auto surfaces = parcel_.add(surface_table(lens.at().front()));
    const auto indices = parcel_.add(lens.table());
    const auto attenuation = parcel_.add(lens.attenuation());
    std::vector<SpecialPlaces<T>> places;
    for (const TraceLens<T>& at : lens.at()) {
        for (const SpecialSurface<T>& special : at.specials) {
            places.push_back(pack_special(parcel_, special));
        }
    }
    const auto specials = parcel_.reserve<typename LensView<T>::Special>(places.size());
    parcel_.allocate(device);
    std::vector<typename LensView<T>::Special> on_device;
    for (const TraceLens<T>& at : lens.at()) {
        for (const SpecialSurface<T>& special : at.specials) {
            on_device.push_back(special_on_device(parcel_, special, places[on_device.size()]));
        }
    }
    parcel_.set(specials, std::span<const typename LensView<T>::Special>(on_device));
    parcel_.send(device);
    view_ = {.surfaces = parcel_.address(surfaces),
             .indices = parcel_.address(indices),
             .specials = parcel_.address(specials),
             .attenuation = lens.absorbs() ? parcel_.address(attenuation) : nullptr,
             .surface_count = lens.surfaces(),
             .special_count = static_cast<int>(lens.at().front().specials.size()),
             .wavelengths = lens.wavelengths(),
             .image_z = lens.at().front().image_z};
}

template class DeviceLens<float>;
template class DeviceLens<double>;

}  // namespace lensproof::optics
