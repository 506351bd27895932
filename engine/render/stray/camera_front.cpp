#include "engine/render/stray/camera_front.h"

#include <fmt/format.h>

#include <cmath>

#include "engine/base/input_error.h"

namespace lensproof::render {

CameraFront::CameraFront(const Camera& camera) : camera_(&camera) {
    if (!traces_in_double(camera.settings().model)) {
        throw InputError(
            fmt::format("the camera's model is \"{}\", expected \"exact\": in no other one does light go astray",
                        name_of(camera.settings().model)));
    }
    optics::require_refraction_alone(camera.lens().value(), "stray light");
    front_ = pupil::front_sphere(middle());
}

std::optional<pupil::EntranceBeam> CameraFront::beam(const LightOrigin& from) const {
    const LightOrigin origin = camera_->in_lens_space(from);
    const auto beam =
        origin.is_far ? std::optional(pupil::beam_along(front_, origin.at)) : pupil::beam_from(front_, origin.at);
    return beam && beam->axis.direction.z > -1.0 ? beam : std::nullopt;
}

Entry CameraFront::entry(const LightOrigin& from, const pupil::EntranceBeam& beam, Vec2d offset, double pdf) const {
    const Ray<double> ray = camera_->to_world(beam.ray(offset));
    return {.direction = ray.direction,
            .end = from.is_far ? ray.origin : from.at + std::hypot(beam.distance, offset.x, offset.y) * ray.direction,
            .pdf = from.is_far ? pdf : pdf / beam.solid_angle_per_mm2(offset)};
}

std::optional<CameraFront::Meeting> CameraFront::meet(const Ray<double>& ray) const {
    const Vec3d origin = camera_->in_lens_space({ray.origin, false}).at;
    const Vec3d direction = camera_->in_lens_space({ray.direction, true}).at;
    const Vec3d towards = front_.centre - origin;
    if (!(direction.z > -1.0) || !(dot(towards, direction) > front_.radius)) {
        return std::nullopt;
    }
    Meeting meeting{.beam = pupil::beam_along(front_, direction), .offset = {}};
    meeting.offset = {-dot(towards, meeting.beam.across[0]), -dot(towards, meeting.beam.across[1])};
    return length(meeting.offset) <= meeting.beam.radius ? std::optional(meeting) : std::nullopt;
}

Entry CameraFront::entry(const Ray<double>& ray, const Meeting& meeting) const {
    return {.direction = ray.direction, .end = camera_->to_world(meeting.beam.ray(meeting.offset)).origin};
}

Vec2d CameraFront::film_px(const Ray<double>& ray, const optics::TraceLens<double>& lens) const {
    const Vec3d point = optics::meet_plane(ray, lens.image_z).point;
    return camera_->sensor().pixel({point.x, point.y});
}

double CameraFront::clear(const Ray<double>& ray) const {
    const auto& dust = camera_->lens()->dust;
    return dust ? dust->clear(ray, middle()) : 1.0;
}

double CameraFront::clear(const Vec3d& front) const {
    const auto& dust = camera_->lens()->dust;
    return dust ? dust->clear(front) : 1.0;
}

double CameraFront::film_radius_mm() const {
    return camera_->sensor().half_diagonal_mm(camera_->film().filter.radius_px() - 0.5);
}

}  // namespace lensproof::render
