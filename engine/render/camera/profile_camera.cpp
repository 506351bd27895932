#include "engine/render/camera/profile_camera.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <span>

#include "engine/base/angle.h"
#include "engine/base/bytes.h"
#include "engine/base/disc.h"
#include "engine/base/infinity.h"
#include "engine/base/input_error.h"
#include "engine/render/camera/survivors.h"

namespace lensproof::render {

namespace {

double square(double x) {
    return x * x;
}

}  // namespace

template <class Profiles, class Of>
ProfileCamera::CurveColumns::CurveColumns(const Profiles& profiles, const Of& of) {
    constexpr std::size_t kNumbers = 4;
    for (const auto& profile : profiles) {
        pieces_each = std::max(pieces_each, of(profile).steps() + 1);
    }
    for (const auto& profile : profiles) {
        const RadialCurve& curve = of(profile);
        per_step.push_back(curve.per_step());
        end.push_back(curve.end());
        curve.append_pieces(pieces);
        const RadialCurve::At last = curve.at(curve.end());
        pieces.insert(pieces.end(), {last.value, curve.end() > 0.0 ? last.slope / curve.per_step() : 0.0, 0.0, 0.0});
        pieces.resize(end.size() * pieces_each * kNumbers);
    }
}

ProfileCamera::ProfileCamera(LensProfile profile, const ProfileOpening& opening)
    : profile_(std::move(profile)),
      opening_(opening),
      is_found_in_a_step_(std::ranges::all_of(
          profile_.at, [](const RadialProfile& at) { return at.field_angle.is_found_in_a_step(); })),
      field_angle_(
          profile_.at, [](const RadialProfile& at) -> auto& { return at.field_angle.curve(); }),
      radius_(
          profile_.at, [](const RadialProfile& at) -> auto& { return at.field_angle.inverse(); }),
      illumination_(
          profile_.at, [](const RadialProfile& at) -> auto& { return at.illumination; }),
      pupil_z_(std::span(&profile_.pupil_z, 1), std::identity()) {
    constexpr int kLooks = 1024;
    const double last_field = profile_.pupil_z.end();
    const double axial_z = profile_.pupil_z.at(0.0).value;
    double farthest_pupil = 0.0;
    double nearest_focus = kInfinity;
    for (int i = 0; i <= kLooks; ++i) {
        const RadialCurve::At pupil = profile_.pupil_z.at(last_field * i / kLooks);
        steepest_pupil_ = std::max(steepest_pupil_, std::abs(pupil.slope));
        farthest_pupil = std::max(farthest_pupil, std::abs(pupil.value - axial_z));
        nearest_focus = std::min(nearest_focus, pupil.value - opening_.focus_z);
    }
    for (std::size_t k = 0; k < profile_.at.size(); ++k) {
        const auto wavelength = static_cast<std::uint16_t>(k);
        const RadialProfile& at = profile_.at[k];
        transmittance_.push_back(at.transmittance);
        for (int i = 0; i <= kLooks; ++i) {
            const double radius = at.field_angle.end() * i / kLooks;
            const RadialCurve::At angle = at.field_angle.at(radius);
            const double area =
                pupil_area(wavelength, radius, angle.slope, std::sin(angle.value), at.illumination.at(radius).value);
            if (i == 0) {
                axial_radius_.push_back(std::sqrt(area / kPi));
            }
            const Vec2d axes = semi_axes(wavelength, area);
            widest_radius_ = std::max({widest_radius_, axes.x, axes.y});
        }
    }
    constexpr double kBetweenLooks = 1.01;
    widest_radius_ = opening_.is_pinhole ? 0.0 : widest_radius_ * kBetweenLooks;
    steepest_pupil_ *= kBetweenLooks;
    lead_mm_ = std::max(0.0, axial_z - profile_.front_z);
    const double reach = steepest_pupil_ + widest_radius_;
    near_mm_ = 4.0 * reach + farthest_pupil + lead_mm_;
    if (!opening_.is_pinhole) {
        largest_vergence_ = 1.0 / nearest_focus;
        if (!(nearest_focus > reach)) {
            throw InputError(fmt::format(
                "the focus lies {:.4g} mm before a pupil; the model thin-lens-profile needs more than {:.4g} mm",
                nearest_focus, reach));
        }
    }
}

/// Of fields beyond the profile's, as at its end: light aims there too.
RadialCurve::At ProfileCamera::pupil_at(double angle) const {
    const double end = profile_.pupil_z.end();
    return angle < end ? profile_.pupil_z.at(angle) : RadialCurve::At{profile_.pupil_z.at(end).value, 0.0};
}

ProfileCamera::Chief ProfileCamera::chief_at(double angle, Vec2d azimuth) const {
    const RadialCurve::At pupil = pupil_at(angle);
    return {.azimuth = azimuth,
            .angle = angle,
            .sine = std::sin(angle),
            .cosine = std::cos(angle),
            .pupil_z = pupil.value,
            .pupil_slope = pupil.slope};
}

ProfileCamera::Chief ProfileCamera::chief_along(const Vec3d& outwards) const {
    const double sine = std::hypot(outwards.x, outwards.y);
    const Vec2d azimuth = sine > 0.0 ? Vec2d{-outwards.x, -outwards.y} / sine : Vec2d{1.0, 0.0};
    return chief_at(std::atan2(sine, -outwards.z), azimuth);
}

/// Newton's steps for the angle θ at which the point is seen from z_e(θ); its angle changes by sin θ / t a mm of z_e,
/// so that beyond all t_c there is one and it is found.
ProfileCamera::Chief ProfileCamera::chief_through(const Vec3d& point) const {
    const double height = std::hypot(point.x, point.y);
    const Vec2d azimuth = height > 0.0 ? Vec2d{-point.x, -point.y} / height : Vec2d{1.0, 0.0};
    double angle = std::atan2(height, pupil_at(0.0).value - point.z);
    constexpr int kMostSteps = 40;
    for (int step = 0; step < kMostSteps; ++step) {
        const RadialCurve::At pupil = pupil_at(angle);
        const double depth = pupil.value - point.z;
        const double per_angle = pupil.slope * height / (height * height + depth * depth);
        const double next = angle + (std::atan2(height, depth) - angle) / (1.0 + per_angle);
        const bool is_found = std::abs(next - angle) <= 4e-16 * angle;
        angle = std::clamp(next, 0.0, kPi);
        if (is_found) {
            break;
        }
    }
    return chief_at(angle, azimuth);
}

std::optional<ProfileCamera::Chief> ProfileCamera::chief_of(const LightOrigin& from) const {
    if (from.is_far) {
        return chief_along(-1.0 * from.at);
    }
    const Vec3d axial{0.0, 0.0, pupil_at(0.0).value};
    return length(from.at - axial) > near_mm_ ? std::optional(chief_through(from.at)) : std::nullopt;
}

double ProfileCamera::pupil_area(std::uint16_t wavelength, double radius, double angle_slope, double sine,
                                 double illumination) const {
    return profile_pupil_area(radius, angle_slope, sine, illumination, profile_.at[wavelength].transmittance);
}

Vec2d ProfileCamera::semi_axes(std::uint16_t wavelength, double area) const {
    return profile_semi_axes(axial_radius_[wavelength], area);
}

ProfileTables ProfileCamera::tables() const {
    return {.field_angle = field_angle_.view(),
            .radius = radius_.view(),
            .illumination = illumination_.view(),
            .pupil_z = pupil_z_.view(),
            .transmittance = transmittance_.data(),
            .axial_radius = axial_radius_.data(),
            .is_pinhole = opening_.is_pinhole,
            .focus_z = opening_.focus_z,
            .lead_mm = lead_mm_};
}

ProfileCamera::Paths::Paths(const ProfileCamera& camera, const FilmSampling& film, const spectral::SpectralGrid& grid,
                            PathCarry carry, std::optional<SimdLevel> level)
    : samples_(film, static_cast<int>(camera.profile_.at.size()), level),
      weigher_(grid, film.sensor, film.filter.is_box(), true, path_kernels(level)),
      rays_(kPathChunk),
      sensor_(film.sensor),
      grid_(grid),
      camera_(&camera),
      kernels_(&path_kernels(level)),
      carry_(carry),
      is_box_(film.filter.is_box()) {}

bool ProfileCamera::Paths::fill(CameraPathBuffer& buffer) {
    const bool is_filled = samples_.fill(buffer, [&](PathStarts& starts) { append(starts, buffer); });
    if (carry_ == PathCarry::wavelengths_and_pdfs || (carry_ == PathCarry::wavelengths && is_box_)) {
        weigher_.weigh(buffer, [&](std::size_t first, SharedPaths& chunk) { meet_film(buffer, first, chunk); });
    }
    if (carry_ != PathCarry::hero && !is_box_) {
        buffer.leave_heroes_alone();
    }
    return is_filled;
}

void ProfileCamera::Paths::append(PathStarts& starts, CameraPathBuffer& buffer) {
    kernels_->leave_profile_camera(camera_->tables(), starts, rays_);
    const Survivors lit(starts.size, [&](std::size_t i) { return starts.weight[i] > 0.0; });
    std::transform(starts.weight.begin(), starts.weight.begin() + starts.size, starts.filter_weight.begin(),
                   starts.weight.begin(), std::multiplies<>());
    buffer.append(starts, rays_, lit.count, [&](const auto* from, auto* to) { lit.copy(from, to); });
    started_ += lit.count;
}

void ProfileCamera::Paths::meet_film(const CameraPathBuffer& buffer, std::size_t first, SharedPaths& chunk) const {
    const auto column = [&](const auto& of) { return of.data() + first; };
    if (camera_->is_found_in_a_step_) {
        const auto vectors = [&](const optics::RayBatch<double>::Vectors& of) {
            return Vec3<const double*>{column(of.x), column(of.y), column(of.z)};
        };
        kernels_->meet_profile_film(camera_->tables(),
                                    {.film = {column(buffer.film_x), column(buffer.film_y)},
                                     .ray = {vectors(buffer.origin), vectors(buffer.direction)}},
                                    chunk);
        return;
    }
    for (std::size_t i = 0; i < static_cast<std::size_t>(chunk.size); ++i) {
        const Ray<double> out = buffer.ray(first + i);
        const FilmImportance found =
            camera_->importance(sensor_, {out.origin, -1.0 * out.direction}, grid_.path(buffer.wavelength[first + i]));
        for (std::size_t m = 0; m < chunk.others.size(); ++m) {
            FilmMeetings& meetings = chunk.others[m];
            const Vec2d at = sensor_.position(found.at_px[m + 1]);
            meetings.film_x[i] = at.x;
            meetings.film_y[i] = at.y;
            meetings.transmittance[i] = found.transmittance[m + 1] > 0.0 ? found.transmittance[m + 1] : -1.0;
            meetings.pupil_pdf[i] = 1.0;
            meetings.per_etendue[i] = found.pdf[m + 1];
        }
    }
}

FilmImportance ProfileCamera::film(const Sensor& sensor, const Meeting& meeting,
                                   const spectral::PathWavelengths& path) const {
    FilmImportance found;
    const Chief& chief = meeting.chief;
    const double g = profile_per_etendue(tables(), chief, meeting.offset);
    for (std::size_t i = 0; i < spectral::kWavelengthsPerPath; ++i) {
        const std::uint16_t wavelength = path.index[i];
        const RadialProfile& at = profile_.at[wavelength];
        const auto place = at.field_angle.where(chief.angle);
        const double illumination = place ? at.illumination.at(place->x).value : 0.0;
        if (!(illumination > 0.0)) {
            continue;
        }
        if (!opening_.is_pinhole) {
            const Vec2d axes =
                semi_axes(wavelength, pupil_area(wavelength, place->x, place->slope, chief.sine, illumination));
            if (square(meeting.offset.x / axes.x) + square(meeting.offset.y / axes.y) > kPupilEdge) {
                continue;
            }
        }
        found.at_px[i] = sensor.pixel(place->x * chief.azimuth);
        found.transmittance[i] = at.transmittance * g;
        found.pdf[i] = found.transmittance[i] / illumination;
    }
    return found;
}

/// Which chief ray a ray into the camera crosses in its focus, and where it passes the pupil.
std::optional<ProfileCamera::Meeting> ProfileCamera::meet(const Ray<double>& ray) const {
    const Vec3d outwards = -1.0 * ray.direction;
    if (opening_.is_pinhole) {
        return Meeting{.chief = chief_along(outwards), .offset = {}};
    }
    const bool has_focus = std::isfinite(opening_.focus_z) && outwards.z < 0.0;
    const Chief chief = has_focus
                            ? chief_through(ray.origin + (opening_.focus_z - ray.origin.z) / outwards.z * outwards)
                            : chief_along(outwards);
    const double towards = dot(outwards, chief.outwards());
    if (!(towards > 0.0)) {
        return std::nullopt;
    }
    const double along = dot(chief.centre() - ray.origin, chief.outwards()) / towards;
    return Meeting{.chief = chief, .offset = chief.across(ray.origin + along * outwards - chief.centre())};
}

FilmImportance ProfileCamera::importance(const Sensor& sensor, const Ray<double>& ray,
                                         const spectral::PathWavelengths& path) const {
    const std::optional<Meeting> meeting = meet(ray);
    return meeting ? film(sensor, *meeting, path) : FilmImportance{};
}

/// The chief ray of a ray from the origin differs from the origin's own by angles of no more than v R at the focus and
/// (R + s) / t at the origin, R being the widest pupil and s how far it is moved by that; and a ball about the pupil is
/// seen somewhat larger from near by.
ProfileCamera::Disc ProfileCamera::disc_of(const LightOrigin& from, const Chief& chief) const {
    const double distance = from.is_far ? kInfinity : length(from.at - chief.centre());
    const double turn = widest_radius_ * (largest_vergence_ + 1.0 / distance);
    const double ball = widest_radius_ + steepest_pupil_ * turn / (1.0 - steepest_pupil_ / distance);
    return {.chief = chief, .radius = ball / std::sqrt(1.0 - square(ball / distance)), .distance = distance};
}

/// 0 where the film does not see so far.
double ProfileCamera::pinhole_pdf(const Disc& disc, std::uint16_t wavelength) const {
    const RadialProfile& at = profile_.at[wavelength];
    const auto place = at.field_angle.where(disc.chief.angle);
    const double illumination = place ? at.illumination.at(place->x).value : 0.0;
    if (!(illumination > 0.0)) {
        return 0.0;
    }
    const double area = pupil_area(wavelength, place->x, place->slope, disc.chief.sine, illumination);
    const double t = disc.distance;
    return std::isfinite(t) ? t * (t + disc.chief.pupil_slope * disc.chief.sine) / area : 1.0 / area;
}

std::optional<LensSample> ProfileCamera::sample(const LightOrigin& from, const spectral::PathWavelengths& path,
                                                double u, double v) const {
    const std::optional<Chief> chief = chief_of(from);
    if (!chief) {
        return std::nullopt;
    }
    const Disc disc = disc_of(from, *chief);
    const Vec2d offset = warped_onto_disc(disc.radius, u, v);
    const Vec3d in_pupil = chief->centre() + chief->across(offset);
    const Vec3d outwards = from.is_far ? -1.0 * from.at : normalized(from.at - in_pupil);
    const Vec3d start = in_pupil + lead_mm_ * outwards;
    const Ray<double> ray{start, -1.0 * outwards};
    const LensSample in{
        .ray = ray, .direction = ray.direction, .end = start, .pdf = pdf(from, {start, outwards}, path)};
    return in.pdf.hero > 0.0 ? std::optional(in) : std::nullopt;
}

PathPdf ProfileCamera::pdf(const LightOrigin& from, const Ray<double>& outwards,
                           const spectral::PathWavelengths& path) const {
    const std::optional<Chief> chief = chief_of(from);
    if (!chief) {
        return {};
    }
    const Disc disc = disc_of(from, *chief);
    if (opening_.is_pinhole) {
        return over_heroes([&](std::size_t i) { return pinhole_pdf(disc, path.index[i]); });
    }
    const double towards = dot(outwards.direction, chief->outwards());
    const double along = dot(chief->centre() - outwards.origin, chief->outwards()) / towards;
    const Vec2d offset = chief->across(outwards.origin + along * outwards.direction - chief->centre());
    if (!(towards > 0.0) || dot(offset, offset) > square(disc.radius) * kPupilEdge) {
        return {};
    }
    const double per_mm2 = 1.0 / (kPi * square(disc.radius));
    const double distance2 = square(disc.distance) + dot(offset, offset);
    const double pdf = from.is_far ? per_mm2 : per_mm2 * distance2 / towards;
    return {.shared = pdf, .hero = pdf};
}

std::string ProfileCamera::bytes() const {
    std::string bytes;
    append_bytes(bytes, opening_.is_pinhole, opening_.focus_z);
    return bytes + profile_.serialized();
}

}  // namespace lensproof::render
