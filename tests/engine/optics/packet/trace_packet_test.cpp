// Packets of rays against the same rays one by one: the same fate, and the same bits.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>
#include <limits>
#include <stdexcept>
#include <string>

#include "engine/base/elementary.h"
#include "engine/formats/prescription/load_lens.h"
#include "engine/optics/convert_lens.h"
#include "engine/optics/device/device_trace.h"
#include "engine/optics/lens.h"
#include "engine/optics/packet/trace_batch.h"
#include "tests/engine/every_device.h"
#include "tests/engine/optics/packet/rays_at.h"
#include "tests/engine/optics/packet/varied_tessars.h"

namespace lensproof::optics::trace_packet_test {

/// Which fates the rays had, so that a test can say that it saw them all.
using Fates = std::array<int, 6>;

Fates operator+(const Fates& a, const Fates& b) {
    Fates sum{};
    std::ranges::transform(a, b, sum.begin(), std::plus<>());
    return sum;
}

/// A batch in packets of every width, and on every device, against the scalar `trace`, ray i at wavelength i modulo
/// their number.
template <Direction direction, class T>
Fates compare_batch(const SpectralLens<T>& lens, const std::vector<Ray<double>>& rays, Rims rims) {
    RayBatch<T> given(static_cast<int>(rays.size()));
    given.size = given.capacity;
    std::vector<TracedRay<T>> alone;
    Fates fates{};
    for (std::size_t i = 0; i < rays.size(); ++i) {
        const Ray<T> ray = convert_ray<T>(rays[i]);
        given.set(static_cast<int>(i), ray);
        given.wavelength[i] = static_cast<std::uint16_t>(static_cast<int>(i) % lens.wavelengths());
        const TraceLens<T>& at = lens.at(given.wavelength[i]);
        alone.push_back(rims == Rims::clip ? trace<direction, Rims::clip>(at, ray)
                                           : trace<direction, Rims::follow>(at, ray));
        ++fates[static_cast<std::size_t>(alone.back().status)];
    }
    // A GPU's exponentials, which coatings take where light fades in a layer, are not this machine's.
    const auto expect_same = [&](const std::string& by, double transmittance_tolerance, const auto& trace_batch_so) {
        RayBatch<T> batch = given;
        trace_batch_so(batch);
        for (std::size_t i = 0; i < rays.size(); ++i) {
            const Ray<T> together = batch.ray(static_cast<int>(i));
            EXPECT_EQ(batch.status[i], alone[i].status) << by << ", ray " << i;
            EXPECT_EQ(batch.surface[i], alone[i].surface) << by << ", ray " << i;
            EXPECT_EQ(together.origin, alone[i].ray.origin) << by << ", ray " << i;
            EXPECT_EQ(together.direction, alone[i].ray.direction) << by << ", ray " << i;
            EXPECT_EQ(batch.optical_path[i], alone[i].optical_path) << by << ", ray " << i;
            EXPECT_NEAR(batch.transmittance[i], alone[i].transmittance, transmittance_tolerance) << by << ", ray " << i;
        }
    };
    for (const SimdLevel level : available_simd_levels()) {
        expect_same(simd_name(level), 0.0, [&](RayBatch<T>& batch) {
            trace_batch<direction>(lens, batch, {.carry = Carry::all, .rims = rims, .level = level});
        });
    }
    const bool is_coated = std::ranges::any_of(
        lens.at().front().specials, [](const SpecialSurface<T>& special) { return !special.coating.layers.empty(); });
    for (const device::Device& device : every_device()) {
        device::SharedDevice shared(device, {}, [](const std::string& why) { ADD_FAILURE() << why; });
        ColumnTracer<T> tracer(lens, &shared);
        const double tolerance = is_coated && device.is_gpu() ? 100.0 * std::numeric_limits<T>::epsilon() : 0.0;
        expect_same(device.name(), tolerance, [&](RayBatch<T>& batch) {
            tracer.template trace<direction>(batch.columns(), {.carry = Carry::all, .rims = rims});
        });
    }
    return fates;
}

/// In both precisions and with both treatments of rims.
template <Direction direction>
Fates compare(const std::vector<TraceLens<double>>& lenses, const std::vector<Ray<double>>& rays) {
    std::vector<TraceLens<float>> in_float;
    std::ranges::transform(lenses, std::back_inserter(in_float), convert_lens<float, double>);
    const SpectralLens<double> of_double(lenses);
    const SpectralLens<float> of_float(in_float);
    Fates fates{};
    for (const Rims rims : {Rims::clip, Rims::follow}) {
        fates =
            fates + compare_batch<direction>(of_double, rays, rims) + compare_batch<direction>(of_float, rays, rims);
    }
    return fates;
}

std::vector<TraceLens<double>> at_three(const Lens& lens) {
    return {at_wavelength<double>(lens, 450.0), at_wavelength<double>(lens, 550.0), at_wavelength<double>(lens, 650.0)};
}

TEST(TracePacket, EveryLaneHasTheBitsOfTheScalar) {
    Fates seen{};
    for (const char* name : {"tessar", "petzval", "muller-fisheye"}) {
        const Lens lens = formats::load_lens(name);
        const std::vector<Ray<double>> rays = rays_at(lens, 801, name[0] == 'm' ? 1.8 : 0.6);
        seen = seen + compare<Direction::forward>(at_three(lens), rays);
        seen = seen + compare<Direction::forward>({at_wavelength<double>(lens, 550.0)}, rays);
    }
    for (const RayStatus status : {RayStatus::ok, RayStatus::missed, RayStatus::clipped,
                                   RayStatus::total_internal_reflection, RayStatus::stopped}) {
        EXPECT_GT(seen[static_cast<std::size_t>(status)], 20) << status_name(status);
    }
}

TEST(TracePacket, GoesBackwardsToo) {
    const Lens lens = formats::load_lens("tessar");
    std::vector<Ray<double>> rays = rays_at(lens, 400, 0.6);
    for (Ray<double>& ray : rays) {
        ray = {{ray.origin.x, ray.origin.y, lens.image_z}, -1.0 * ray.direction};
    }
    const Fates fates = compare<Direction::reverse>(at_three(lens), rays);
    EXPECT_GT(fates[static_cast<std::size_t>(RayStatus::ok)], 20);
}

// What is not asked for stays as it was, and rays beyond the batch's size are not touched.
TEST(TracePacket, LeavesAloneWhatIsNotAskedFor) {
    const Lens lens = formats::load_lens("tessar");
    const SpectralLens<double> at = at_wavelengths<double>(lens, {550.0});
    const std::vector<Ray<double>> rays = rays_at(lens, 40, 0.1);
    for (const SimdLevel level : available_simd_levels()) {
        RayBatch<double> batch(40);
        for (int i = 0; i < 40; ++i) {
            batch.set(i, rays[static_cast<std::size_t>(i)]);
        }
        std::ranges::fill(batch.optical_path, -1.0);
        std::ranges::fill(batch.transmittance, -2.0);
        std::ranges::fill(batch.status, RayStatus::missed);
        batch.size = 21;
        trace_batch(at, batch, {.carry = Carry::geometry, .level = level});
        EXPECT_TRUE(std::ranges::all_of(batch.optical_path, [](double path) { return path == -1.0; }));
        EXPECT_TRUE(std::ranges::all_of(batch.transmittance, [](double passed) { return passed == -2.0; }));
        for (int i = 21; i < 40; ++i) {
            EXPECT_EQ(batch.ray(i).origin, rays[static_cast<std::size_t>(i)].origin);
            EXPECT_EQ(batch.status[static_cast<std::size_t>(i)], RayStatus::missed);
        }
    }
}

TEST(TracePacket, RefusesLensesThatAreNotOne) {
    const TraceLens<double> tessar = at_wavelength<double>(formats::load_lens("tessar"), 550.0);
    const TraceLens<double> petzval = at_wavelength<double>(formats::load_lens("petzval"), 550.0);
    EXPECT_THROW(SpectralLens<double>({tessar, petzval}), std::invalid_argument);
    EXPECT_THROW(SpectralLens<double>({}), std::invalid_argument);
}

// A closed stop stops every lane, the one on the axis too.
TEST(TracePacket, AClosedStopStopsEveryLane) {
    const Lens lens = formats::load_lens("tessar");
    TraceLens<double> at = at_wavelength<double>(lens, 550.0);
    at.surfaces[static_cast<std::size_t>(lens.stop_index())].semi_diameter_squared = 0.0;
    std::vector<Ray<double>> rays = rays_at(lens, 7, 0.1);
    rays.push_back({{0.0, 0.0, -10.0}, {0.0, 0.0, 1.0}});
    const Fates fates = compare<Direction::forward>({at}, rays);
    EXPECT_EQ(fates[static_cast<std::size_t>(RayStatus::ok)], 0);
    EXPECT_GT(fates[static_cast<std::size_t>(RayStatus::stopped)], 0);
}

// Blades, coatings and turned, displaced groups, each at three wavelengths, where a coating's transmittance differs.
TEST(TracePacket, TracesBladesCoatingsAndTurnedGroups) {
    std::vector<Lens> lenses = varied_tessars();
    lenses.push_back(formats::load_lens("heliar-tronnier"));
    for (const Lens& lens : lenses) {
        ASSERT_FALSE(at_wavelength<double>(lens, 550.0).specials.empty());
        const Fates fates = compare<Direction::forward>(at_three(lens), rays_at(lens, 400, 0.4));
        EXPECT_GT(fates[static_cast<std::size_t>(RayStatus::ok)], 20);
        EXPECT_GT(fates[static_cast<std::size_t>(RayStatus::clipped)], 20);
    }
}

TEST(TracePacket, TracesEveryKindOfCoating) {
    const Lens tessar = formats::load_lens("tessar");
    const std::vector<TraceLens<double>> coated = coated_by_turns(at_three(tessar));
    const std::vector<Ray<double>> rays = rays_at(tessar, 400, 0.6);
    EXPECT_GT(compare<Direction::forward>(coated, rays)[static_cast<std::size_t>(RayStatus::ok)], 20);
    const Fates fates = compare<Direction::forward>({coated[0]}, rays);
    EXPECT_GT(fates[static_cast<std::size_t>(RayStatus::ok)], 20);
    EXPECT_GT(fates[static_cast<std::size_t>(RayStatus::total_internal_reflection)], 20);
}

// Of a packet's lanes some fade a little, some so much that a power of two is taken out, and some not at all.
TEST(TracePacket, TracesGlassThatAbsorbs) {
    std::vector<TraceLens<double>> lenses = at_three(formats::load_lens("tessar"));
    const auto absorb_in_glass = [](TraceLens<double>& lens, double attenuation) {
        lens.attenuation = {0.0};
        for (const TraceSurface<double>& surface : lens.surfaces) {
            lens.attenuation.push_back(surface.index_after > 1.1 ? attenuation : 0.0);
        }
    };
    absorb_in_glass(lenses[0], 0.005);
    absorb_in_glass(lenses[2], 0.2);
    const auto fading_on_axis = [&](std::size_t i) {
        const Ray<double> axis{{0.0, 0.0, -10.0}, {0.0, 0.0, 1.0}};
        TraceLens<double> clear = lenses[i];
        clear.attenuation.clear();
        return trace(lenses[i], axis).transmittance / trace(clear, axis).transmittance;
    };
    EXPECT_GT(fading_on_axis(0), std::exp(-kNearZero<double>));
    EXPECT_LT(fading_on_axis(2), std::exp(-kNearZero<double>));
    const std::vector<Ray<double>> rays = rays_at(formats::load_lens("tessar"), 400, 0.4);
    EXPECT_GT(compare<Direction::forward>(lenses, rays)[static_cast<std::size_t>(RayStatus::ok)], 20);
    EXPECT_GT(compare<Direction::forward>({lenses[2]}, rays)[static_cast<std::size_t>(RayStatus::ok)], 20);
}

// Mangin's mirror: glass that light crosses twice, there with the other sign.
TEST(TracePacket, TracesMirrors) {
    StatedMedium glass;
    glass.n_d = 1.5168;
    Prescription mangin{.name = "Mangin", .surfaces = {}};
    mangin.surfaces = {
        {.radius_mm = -150.0, .thickness_mm = 8.0, .semi_diameter_mm = 30.0, .medium = glass, .is_stop = true},
        {.radius_mm = -240.0, .thickness_mm = -8.0, .semi_diameter_mm = 29.0, .medium = {}, .is_mirror = true},
        {.radius_mm = -150.0, .thickness_mm = -160.0, .semi_diameter_mm = 29.0, .medium = {}}};
    set_mirror_media(mangin.surfaces);
    const Lens lens = make_lens(mangin, {});
    std::vector<TraceLens<double>> at = at_three(lens);
    for (const std::optional<double> reflectance : {std::optional<double>(), {0.9}}) {
        for (TraceLens<double>& one : at) {
            ASSERT_EQ(one.specials.size(), 1U);
            one.specials[0].coating.reflectance = reflectance;
        }
        const Fates fates = compare<Direction::forward>(at, rays_at(lens, 400, 0.3));
        EXPECT_GT(fates[static_cast<std::size_t>(RayStatus::ok)], 20);
        EXPECT_GT(fates[static_cast<std::size_t>(RayStatus::clipped)], 20);
    }
}

// An ideal lens behind a grating and a kinoform on a curved, tilted surface, at three wavelengths: their phases differ
// from lane to lane, and some orders are evanescent.
TEST(TracePacket, TracesThinElements) {
    Prescription prescription{.name = "thin", .surfaces = {}};
    PrescribedSurface ruled{.radius_mm = -60.0, .thickness_mm = 8.0, .semi_diameter_mm = 12.0, .medium = {}};
    ruled.phase = PhaseElement{.order = 1.0, .lines_per_mm = 1500.0, .radial = {1e-3, -1e-7}};
    ruled.phase->design_wavelength_nm = 600.0;
    ruled.misalignment.tilt_deg = {10.0, 0.0, 30.0};
    PrescribedSurface ideal{.thickness_mm = 40.0, .semi_diameter_mm = 9.0, .medium = {}, .is_stop = true};
    ideal.ideal_focal_length_mm = 40.0;
    prescription.surfaces = {ruled, ideal};
    const Lens lens = make_lens(prescription, {});
    const Fates fates = compare<Direction::forward>(at_three(lens), rays_at(lens, 600, 0.6));
    for (const RayStatus status : {RayStatus::ok, RayStatus::clipped, RayStatus::evanescent}) {
        EXPECT_GT(fates[static_cast<std::size_t>(status)], 10) << status_name(status);
    }
}

// A shaped, displaced surface.
TEST(TracePacket, TracesWhatIsNoSphere) {
    const Lens lens = formats::load_lens("tessar");
    TraceLens<double> at = at_wavelength<double>(lens, 550.0);
    SpecialSurface<double> special;
    special.has_shape = true;
    special.shape = {.curvature = at.surfaces[2].curvature, .conic = -0.5, .asphere = {0.0, 1e-6}, .terms = 2};
    special.vertex = {0.0, 0.3};
    at.specials.push_back(special);
    at.surfaces[2].special = 0;
    for (const int odd_terms : {0, 2}) {
        at.specials[0].shape.odd_asphere = {1e-3, -2e-5};
        at.specials[0].shape.odd_terms = odd_terms;
        const Fates fates = compare<Direction::forward>({at}, rays_at(lens, 400, 0.6));
        EXPECT_GT(fates[static_cast<std::size_t>(RayStatus::ok)], 20);
    }
}

}  // namespace lensproof::optics::trace_packet_test
