#include "engine/render/stray/ghost_guide.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>

#include "engine/analysis/ghost_light.h"
#include "engine/analysis/ghost_orders.h"
#include "engine/base/angle.h"
#include "engine/base/bytes.h"
#include "engine/optics/lens_bytes.h"
#include "engine/optics/paraxial.h"
#include "ghost_digest.h"

namespace lensproof::render {

namespace {

constexpr double kStep = 2.5 * kDegree;
constexpr std::size_t kAngles = 49;  // to 120°: few fronts are met by light from farther behind
constexpr int kRaysOfGhost = 400;    // to weigh it

}  // namespace

/// Where a beam stands among the angles, and how its offsets are turned there.
struct GhostGuide::Place {
    std::size_t below = 0;  // a number of steps
    double above = 0.0;     // how often the next angle is taken
    Vec2d azimuth;          // a beam turned about the axis has its offsets turned with it

    [[nodiscard]] Vec2d to_meridional(Vec2d offset) const {
        return {azimuth.y * offset.x - azimuth.x * offset.y, azimuth.x * offset.x + azimuth.y * offset.y};
    }
    [[nodiscard]] Vec2d from_meridional(Vec2d offset) const {
        return {azimuth.y * offset.x + azimuth.x * offset.y, azimuth.y * offset.y - azimuth.x * offset.x};
    }
};

GhostGuide::GhostGuide(const optics::Lens& lens, optics::TraceLens<double> traced,
                       const optics::StrayMirrors<double>& mirrors, double film_radius_mm, bool searches,
                       const Cache& cache)
    : lens_(std::move(traced)),
      mirrors_(mirrors),
      film_radius_mm_(film_radius_mm),
      cache_(cache),
      is_known_(searches && lens.is_rotationally_symmetric) {
    const analysis::FrontBeam along_axis(lens_, 0.0);
    const double diameter = optics::paraxial_data(lens_).entrance_pupil_diameter;
    pupil_area_ = std::min(0.25 * kPi * diameter * diameter, along_axis.area());
    paths_ = analysis::ghosts_of_two({.lens = lens_,
                                      .beam = along_axis,
                                      .mirrors = mirrors,
                                      .image_radius = film_radius_mm,
                                      .pupil_area = pupil_area_});
    while (angles_.size() < kAngles) {
        angles_.push_back(std::make_unique<Angle>());
    }
}

std::string GhostGuide::Known::serialized() const {
    std::string bytes;
    append_bytes(bytes, static_cast<std::uint32_t>(regions.size()), static_cast<std::uint32_t>(cumulative.size()));
    for (const double weight : cumulative) {
        append_bytes(bytes, weight);
    }
    for (const analysis::GhostRegion& region : regions) {
        append_bytes(bytes, region.across, region.cell, region.corner.x, region.corner.y, region.search_rays,
                     static_cast<std::uint32_t>(region.cells.size()));
        for (const analysis::GridCell& cell : region.cells) {
            append_bytes(bytes, cell.x, cell.y);
        }
    }
    return bytes;
}

std::optional<GhostGuide::Known> GhostGuide::Known::deserialized(std::string_view bytes) {
    bool is_whole = true;
    const auto take = [&]<class Number>(Number& number) {
        const auto taken = take_bytes<Number>(bytes);
        is_whole = is_whole && taken;
        number = taken.value_or(Number{});
    };
    const auto take_count = [&](std::size_t bytes_each) {
        std::uint32_t count = 0;
        take(count);
        is_whole = is_whole && count <= bytes.size() / bytes_each;
        return is_whole ? count : 0;
    };
    Known known;
    known.regions.resize(take_count(1));
    known.cumulative.resize(take_count(sizeof(double)));
    std::ranges::for_each(known.cumulative, take);
    for (analysis::GhostRegion& region : known.regions) {
        take(region.across);
        take(region.cell);
        take(region.corner.x);
        take(region.corner.y);
        take(region.search_rays);
        region.cells.resize(take_count(2 * sizeof(int)));
        for (auto& [x, y] : region.cells) {
            take(x);
            take(y);
        }
        region.held = analysis::HeldCells(region.cells);
    }
    return is_whole && bytes.empty() ? std::optional(std::move(known)) : std::nullopt;
}

std::string GhostGuide::key_of(double radians) const {
    std::string key(kGhostDigest);
    append_bytes(key, radians, mirrors_.sensor, mirrors_.blades, film_radius_mm_, pupil_area_);
    optics::append_lens_bytes(key, lens_);
    return key;
}

GhostGuide::Known GhostGuide::traced(double radians) const {
    const analysis::GhostScene scene{.lens = lens_,
                                     .beam = analysis::FrontBeam(lens_, radians),
                                     .mirrors = mirrors_,
                                     .image_radius = film_radius_mm_,
                                     .pupil_area = pupil_area_ * std::max(0.1, std::cos(radians))};
    Known known;
    double sum = 0.0;
    for (const optics::GhostPath& path : paths_) {
        analysis::GhostRegion& region = known.regions.emplace_back(analysis::ghost_region(scene, path));
        sum += region.cells.empty() ? 0.0 : analysis::measure_ghost(scene, path, region, {.rays = kRaysOfGhost}).energy;
        known.cumulative.push_back(sum);
    }
    for (double& weight : known.cumulative) {
        weight /= sum;
    }
    if (!(sum > 0.0)) {
        known.cumulative.clear();
    }
    return known;
}

void GhostGuide::look_at(Angle& angle, double radians) const {
    angle.known = kept<Known>(cache_, "ghosts", key_of(radians), [&] { return traced(radians); });
    const pupil::BoundingSphere front = pupil::front_sphere(lens_);
    const pupil::EntranceBeam beam = pupil::beam_along(front, {0.0, std::sin(radians), std::cos(radians)});
    angle.centre = {dot(front.centre, beam.across[0]), dot(front.centre, beam.across[1])};
}

const GhostGuide::Angle* GhostGuide::angle(std::size_t steps) const {
    if (!is_known_ || steps >= angles_.size()) {
        return nullptr;
    }
    Angle& found = *angles_[steps];
    std::call_once(found.once, [&] { look_at(found, static_cast<double>(steps) * kStep); });
    return found.known.cumulative.empty() ? nullptr : &found;
}

GhostGuide::Place GhostGuide::place_of(const pupil::EntranceBeam& beam) const {
    const Vec3d& direction = beam.axis.direction;
    const double across = std::hypot(direction.x, direction.y);
    const double at = std::atan2(across, direction.z) / kStep;
    const double below = std::floor(at);
    return {.below = static_cast<std::size_t>(below),
            .above = at - below,
            .azimuth = across > 0.0 ? Vec2d{direction.x / across, direction.y / across} : Vec2d{0.0, 1.0}};
}

std::optional<GhostGuide::Draw> GhostGuide::draw(const pupil::EntranceBeam& beam,
                                                 const std::array<double, 3>& numbers) const {
    const Place place = place_of(beam);
    const bool takes_next = numbers[0] < place.above;
    const Angle* at = angle(takes_next ? place.below + 1 : place.below);
    if (at == nullptr) {
        return std::nullopt;
    }
    const double rest = takes_next ? numbers[0] / place.above : (numbers[0] - place.above) / (1.0 - place.above);
    const auto found = std::ranges::upper_bound(at->known.cumulative, rest);
    const auto ghost =
        std::min(static_cast<std::size_t>(found - at->known.cumulative.begin()), at->known.cumulative.size() - 1);
    const analysis::GhostRegion& region = at->known.regions[ghost];
    if (region.cells.empty()) {
        return std::nullopt;
    }
    const double along_cells = numbers[1] * static_cast<double>(region.cells.size());
    const std::size_t cell = std::min(static_cast<std::size_t>(along_cells), region.cells.size() - 1);
    const Vec2d in_region{
        region.cell * (region.cells[cell].x + along_cells - static_cast<double>(cell)),
        region.cell * (region.cells[cell].y + numbers[2]),
    };
    return Draw{.ghost = ghost, .offset = place.from_meridional(region.corner + in_region - at->centre)};
}

double GhostGuide::pdf(const pupil::EntranceBeam& beam, const Draw& drawn) const {
    const Place place = place_of(beam);
    const Vec2d meridional = place.to_meridional(drawn.offset);
    double pdf = 0.0;
    for (const auto& [steps, weight] : {std::pair{place.below, 1.0 - place.above}, {place.below + 1, place.above}}) {
        const Angle* at = weight > 0.0 ? angle(steps) : nullptr;
        if (at != nullptr && at->known.regions[drawn.ghost].contains(meridional + at->centre)) {
            const double before = drawn.ghost > 0 ? at->known.cumulative[drawn.ghost - 1] : 0.0;
            pdf += weight * (at->known.cumulative[drawn.ghost] - before) / at->known.regions[drawn.ghost].area();
        }
    }
    return pdf;
}

double GhostGuide::probability(const pupil::EntranceBeam& beam, std::size_t ghost) const {
    const Place place = place_of(beam);
    double probability = 0.0;
    for (const auto& [steps, weight] : {std::pair{place.below, 1.0 - place.above}, {place.below + 1, place.above}}) {
        if (const Angle* at = weight > 0.0 ? angle(steps) : nullptr; at != nullptr) {
            probability += weight * (at->known.cumulative[ghost] - (ghost > 0 ? at->known.cumulative[ghost - 1] : 0.0));
        }
    }
    return probability;
}

}  // namespace lensproof::render
