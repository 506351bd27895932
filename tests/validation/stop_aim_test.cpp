// Rays aimed from the stop at where light comes from, against rays traced forward.
#include "engine/optics/stop_aim.h"

#include <gtest/gtest.h>

#include <cmath>
#include <optional>
#include <random>
#include <vector>

#include "engine/base/angle.h"
#include "engine/formats/prescription/load_lens.h"
#include "engine/optics/focus.h"
#include "engine/optics/paraxial.h"
#include "engine/pupil/entrance_beam.h"

namespace lensproof::stop_aim_test {

constexpr double kWavelength_nm = 550.0;

struct Setting {
    std::string lens;
    double f_number;
    std::vector<double> fields_deg;
};

// Wide open, where the map bends most, and to the last light of fisheyes, which comes from behind.
const std::vector<Setting> kSettings = {{"tessar", 2.8, {0.0, 10.0, 20.0}},
                                        {"double-gauss-tronnier", 2.0, {0.0, 14.0}},
                                        {"distagon-28", 8.0, {30.0}},
                                        {"muller-fisheye", 8.0, {0.0, 50.0, 70.0}},
                                        {"fisheye-220", 2.8, {60.0, 100.0}}};

/// Where a ray that comes forward meets the stop and how much of it, if nothing before is in its way.
struct AtStop {
    Vec2d point;
    double transmittance = 0.0;
};
std::optional<AtStop> at_stop(const optics::TraceLens<double>& lens, int stop, const Ray<double>& ray) {
    std::optional<AtStop> found;
    double before = 1.0;
    optics::trace<optics::Direction::forward, optics::Rims::follow>(
        lens, ray, [&](const optics::SurfaceEvent<double>& event) {
            if (event.surface < stop && event.status != optics::RayStatus::ok) {
                before = 0.0;
            }
            if (event.surface == stop && before > 0.0) {
                found = AtStop{{event.ray.origin.x, event.ray.origin.y}, event.transmittance};
            }
        });
    return found;
}

// Every ray of a beam, far or from a metre away, that falls just inside the stop's rim is found again from its point
// there: the same ray within 1e-6 mm at the front, the same transmittance, and the beam's spread over the stop that
// rays beside it show, by central differences with 1e-3 mm steps (error 1e-6 of what bends over a mm).
TEST(StopAim, FindsTheRaysThatReachTheStop) {
    std::mt19937_64 random(3);
    std::uniform_real_distribution<double> unit(-1.0, 1.0);
    for (const auto& [name, f_number, fields] : kSettings) {
        const optics::Lens lens = optics::with_f_number(formats::load_lens(name), f_number);
        const auto at = optics::at_wavelength<double>(lens, kWavelength_nm);
        const optics::StopAim aim(at, lens.stop_index());
        const pupil::BoundingSphere front = pupil::front_sphere(at);
        for (const double field : fields) {
            for (const double distance : {kInfinity, 1000.0}) {
                const Vec3d direction{0.0, std::sin(radians(field)), std::cos(radians(field))};
                const pupil::EntranceBeam beam = pupil::beam_along(front, direction, distance);
                const bool is_far = distance == kInfinity;
                const optics::RayOrigin origin{is_far ? direction : front.centre - distance * direction, is_far};
                const auto chief = aim.aim(origin, {});
                ASSERT_TRUE(chief) << name << " " << field;
                const Vec3d start = chief->front.origin - front.centre;
                const Vec3d crossing =
                    start - (dot(start, direction) / dot(chief->front.direction, direction)) * chief->front.direction;
                const Vec2d middle{dot(crossing, beam.across[0]), dot(crossing, beam.across[1])};
                const double reach = optics::paraxial_data(at).entrance_pupil_diameter;
                int seen = 0;
                for (int i = 0; i < 200'000 && seen < 100; ++i) {
                    const Vec2d offset = middle + (reach * Vec2d{unit(random), unit(random)});
                    const Ray<double> ray = beam.ray(offset);
                    const auto stop = at_stop(at, lens.stop_index(), ray);
                    const double a = aim.semi_diameter();
                    if (!stop || length(stop->point) > a || length(stop->point) < 0.97 * a) {
                        continue;
                    }
                    ++seen;
                    const auto found = aim.aim(origin, stop->point);
                    ASSERT_TRUE(found) << name << " " << field;
                    EXPECT_LT(length(found->front.direction - ray.direction), 1e-6) << name << " " << field;
                    EXPECT_NEAR(found->transmittance, stop->transmittance, 1e-6);
                    constexpr double kStep = 1e-3;
                    const auto beside = [&](Vec2d by) {
                        return at_stop(at, lens.stop_index(), beam.ray(offset + by)).value_or(AtStop{}).point;
                    };
                    const Vec2d by_x = (beside({kStep, 0.0}) - beside({-kStep, 0.0})) / (2.0 * kStep);
                    const Vec2d by_y = (beside({0.0, kStep}) - beside({0.0, -kStep})) / (2.0 * kStep);
                    const double spread =
                        (is_far ? 1.0 : beam.solid_angle_per_mm2(offset)) / std::abs(cross(by_x, by_y));
                    EXPECT_NEAR(found->beam_per_mm2 / spread, 1.0, 1e-4) << name << " " << field;
                }
                EXPECT_GE(seen, 100) << name << " " << field;
            }
        }
    }
}

}  // namespace lensproof::stop_aim_test
