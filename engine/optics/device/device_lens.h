// engine/optics/device/device_lens.h — a lens in a device's memory.
#pragma once
#include "engine/device/parcel.h"
#include "engine/optics/device/lens_view.h"
#include "engine/optics/packet/spectral_lens.h"

namespace lensproof::optics {

/// Throws device::Error where it does not fit.
template <class T>
class DeviceLens {
  public:
    DeviceLens(const device::Device& device, const SpectralLens<T>& lens);

    /// For jobs on that device; this outlives them.
    [[nodiscard]] const LensView<T>& view() const { return view_; }

  private:
    device::Parcel parcel_;
    LensView<T> view_;
};

extern template class DeviceLens<float>;
extern template class DeviceLens<double>;

}  // namespace lensproof::optics
