#include "engine/analysis/sampled_pupil.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <queue>

#include "engine/base/infinity.h"

namespace lensproof::analysis {

namespace {

constexpr int kEdgeSamples = 8;  // per side of a cell at the rim

/// d(direction cosines) / d(offset), 1/mm.
struct Jacobian {
    double xx = 0.0;
    double xy = 0.0;
    double yx = 0.0;
    double yy = 0.0;

    [[nodiscard]] double determinant() const { return xx * yy - xy * yx; }
    [[nodiscard]] Vec2d solve(Vec2d v) const {
        const double d = determinant();
        return {(yy * v.x - xy * v.y) / d, (xx * v.y - yx * v.x) / d};
    }
};

/// A ray aimed into a given direction.
struct AimedRay {
    Vec2d offset;
    ImageRay ray;
    Jacobian slope;  // about that of the map there, good for the next step
};

/// Finds rays by the direction in which they leave.
class Aim {
  public:
    Aim(const PolychromaticField& field, const PolychromaticField::Part& part)
        : field_(field), part_(part), step_(1e-4 * std::sqrt(part.outline.area)) {}

    [[nodiscard]] std::optional<ImageRay> ray(Vec2d offset) const { return image_ray(part_, field_, offset); }

    /// By central differences: the error is that of third derivatives times step², some 1e-9 of the whole.
    [[nodiscard]] std::optional<Jacobian> jacobian(Vec2d at) const {
        const auto right = ray(at + Vec2d{step_, 0.0});
        const auto left = ray(at - Vec2d{step_, 0.0});
        const auto up = ray(at + Vec2d{0.0, step_});
        const auto down = ray(at - Vec2d{0.0, step_});
        if (!right || !left || !up || !down) {
            return std::nullopt;
        }
        const double scale = 0.5 / step_;
        return Jacobian{.xx = scale * (right->direction.x - left->direction.x),
                        .xy = scale * (up->direction.x - down->direction.x),
                        .yx = scale * (right->direction.y - left->direction.y),
                        .yy = scale * (up->direction.y - down->direction.y)};
    }

    /// Broyden's method from a guess, until the rest is laid on by the slope: dV = −ε · (error in direction), and what
    /// that leaves is the square of 1e-7 times some mm of depth.
    [[nodiscard]] std::optional<AimedRay> towards(Vec2d cosines, Vec2d guess, Jacobian slope) const {
        constexpr double kTolerance = 1e-7;
        constexpr int kSteps = 30;
        std::optional<ImageRay> here = ray(guess);
        for (int i = 0; here && i < kSteps; ++i) {
            const Vec2d error = cosines - Vec2d{here->direction.x, here->direction.y};
            const Vec2d move = slope.solve(error);
            guess = guess + move;
            if (length(error) < kTolerance) {
                here->path -= dot(here->aberration, error);
                here->direction.x = cosines.x;
                here->direction.y = cosines.y;
                return AimedRay{guess, *here, slope};
            }
            here = ray(guess);
            if (here) {
                // What the slope left over, laid on the step.
                const double left_x = here->direction.x - cosines.x;
                const double left_y = here->direction.y - cosines.y;
                const double square = dot(move, move);
                slope.xx += left_x * move.x / square;
                slope.xy += left_x * move.y / square;
                slope.yx += left_y * move.x / square;
                slope.yy += left_y * move.y / square;
            }
        }
        return std::nullopt;
    }

    /// The fraction of a cell around `aimed` whose rays pass, by the map's linear part.
    [[nodiscard]] double open_fraction(const AimedRay& aimed, const Jacobian& slope, double spacing) const {
        int open = 0;
        for (int i = 0; i < kEdgeSamples; ++i) {
            for (int k = 0; k < kEdgeSamples; ++k) {
                const Vec2d within{spacing * ((k + 0.5) / kEdgeSamples - 0.5),
                                   spacing * ((i + 0.5) / kEdgeSamples - 0.5)};
                const Ray<double> ray = field_.bundle.ray(aimed.offset + slope.solve(within));
                open += optics::trace(part_.lens, ray).status == optics::RayStatus::ok ? 1 : 0;
            }
        }
        return static_cast<double>(open) / (kEdgeSamples * kEdgeSamples);
    }

  private:
    const PolychromaticField& field_;
    const PolychromaticField::Part& part_;
    double step_;
};

/// The cells' rays, spread from the one next to the beam's middle to the neighbours of every cell whose ray passes.
class CellRays {
  public:
    CellRays(const Aim& aim, const SampledPupil& grid, Vec2d start) : grid_(grid), rays_(grid.amplitude.size()) {
        const std::optional<ImageRay> ray = aim.ray(start);
        const std::optional<Jacobian> slope = aim.jacobian(start);
        if (!ray || !slope) {
            return;
        }
        const auto nearest = [&](double cosine, double middle) {
            const auto cell = static_cast<int>(std::lround((cosine - middle) / grid.spacing + 0.5 * (grid.size - 1)));
            return std::clamp(cell, 0, grid.size - 1);
        };
        visit(aim, nearest(ray->direction.y, grid.centre.y), nearest(ray->direction.x, grid.centre.x),
              {start, *ray, *slope});
        while (!front_.empty()) {
            const auto [row, column] = front_.front();
            front_.pop();
            const AimedRay from = *rays_[grid.cell(row, column)];
            for (int r = std::max(0, row - 1); r <= std::min(grid.size - 1, row + 1); ++r) {
                for (int c = std::max(0, column - 1); c <= std::min(grid.size - 1, column + 1); ++c) {
                    visit(aim, r, c, from);
                }
            }
        }
    }

    [[nodiscard]] const std::optional<AimedRay>& at(int row, int column) const {
        return rays_[grid_.cell(row, column)];
    }

    /// d(cosines) / d(offset) at a solved cell, from the neighbours two to each side by differences of fourth order, or
    /// else by tracing.
    [[nodiscard]] Jacobian jacobian(const Aim& aim, int row, int column) const {
        const std::optional<Vec2d> by_x = difference(row, column, 0, 1);
        const std::optional<Vec2d> by_y = difference(row, column, 1, 0);
        if (by_x && by_y) {
            // The inverse of d(offset) / d(cosines).
            const double d = by_x->x * by_y->y - by_y->x * by_x->y;
            return {.xx = by_y->y / d, .xy = -by_y->x / d, .yx = -by_x->y / d, .yy = by_x->x / d};
        }
        return aim.jacobian(at(row, column)->offset).value_or(at(row, column)->slope);
    }

    /// Whether the cell and all of its neighbours pass.
    [[nodiscard]] bool is_inner(int row, int column) const {
        for (int r = row - 1; r <= row + 1; ++r) {
            for (int c = column - 1; c <= column + 1; ++c) {
                const bool is_cell = r >= 0 && c >= 0 && r < grid_.size && c < grid_.size;
                if (!is_cell || !at(r, c) || !at(r, c)->ray.passes) {
                    return false;
                }
            }
        }
        return true;
    }

  private:
    /// The change of the offset per direction cosine along rows or columns.
    [[nodiscard]] std::optional<Vec2d> difference(int row, int column, int down, int right) const {
        Vec2d sum{};
        for (const auto& [step, factor] : {std::pair{-2, 1.0}, {-1, -8.0}, {1, 8.0}, {2, -1.0}}) {
            const int r = row + step * down;
            const int c = column + step * right;
            if (r < 0 || c < 0 || r >= grid_.size || c >= grid_.size || !at(r, c)) {
                return std::nullopt;
            }
            sum = sum + factor / (12.0 * grid_.spacing) * at(r, c)->offset;
        }
        return sum;
    }

    void visit(const Aim& aim, int row, int column, const AimedRay& from) {
        std::optional<AimedRay>& mine = rays_[grid_.cell(row, column)];
        if (mine) {
            return;
        }
        const Vec2d target = grid_.cosines(row, column);
        const Vec2d move = from.slope.solve(target - Vec2d{from.ray.direction.x, from.ray.direction.y});
        mine = aim.towards(target, from.offset + move, from.slope);
        if (mine && mine->ray.passes) {
            front_.push({row, column});
        }
    }

    const SampledPupil& grid_;
    std::vector<std::optional<AimedRay>> rays_;
    std::queue<std::array<int, 2>> front_;
};

}  // namespace

CosineBox cosine_box(const PolychromaticField& field, const PolychromaticField::Part& part) {
    CosineBox box{{kInfinity, kInfinity}, {-kInfinity, -kInfinity}};
    for (const optics::OutlinePoint& point : part.outline.points) {
        for (const double side : {1.0, -1.0}) {
            if (side < 0.0 && !part.outline.is_half) {
                continue;
            }
            // A limit that no rim is (a total reflection) may let nothing pass on the very edge.
            for (const double t : {1.0, 0.999}) {
                const Vec2d inside = part.outline.at(point, t);
                const Vec2d offset{side * inside.x, inside.y};
                if (const std::optional<ImageRay> ray = image_ray(part, field, offset)) {
                    box.low = {std::min(box.low.x, ray->direction.x), std::min(box.low.y, ray->direction.y)};
                    box.high = {std::max(box.high.x, ray->direction.x), std::max(box.high.y, ray->direction.y)};
                    break;
                }
            }
        }
    }
    return box;
}

int pupil_cells(double width, double spacing) {
    constexpr double kMost = 1e6;
    return static_cast<int>(std::lround(std::min(kMost, 1.01 * width / spacing))) + 3;
}

SampledPupil sample_pupil(const PolychromaticField& field, const PolychromaticField::Part& part, double spacing) {
    SampledPupil pupil;
    pupil.wavelength_nm = part.wavelength_nm;
    pupil.weight = part.weight;
    pupil.spacing = spacing;
    const CosineBox box = cosine_box(field, part);
    if (!(box.width() > 0.0)) {
        return pupil;
    }
    pupil.size = pupil_cells(box.width(), spacing);
    pupil.centre = 0.5 * (box.low + box.high);
    const std::size_t cells = static_cast<std::size_t>(pupil.size) * static_cast<std::size_t>(pupil.size);
    pupil.fraction.assign(cells, 0.0);
    pupil.amplitude.assign(cells, 0.0);
    pupil.path.assign(cells, 0.0);
    pupil.offset.assign(cells, {});
    pupil.aberration.assign(cells, {});

    const Aim aim(field, part);
    const CellRays rays(aim, pupil, part.outline.centre);
    const double mean_path = aim.ray(part.outline.centre).value_or(ImageRay{}).path;
    int turned = 0;
    int straight = 0;
    for (int row = 0; row < pupil.size; ++row) {
        for (int column = 0; column < pupil.size; ++column) {
            const std::optional<AimedRay>& aimed = rays.at(row, column);
            if (!aimed) {
                continue;
            }
            const Jacobian slope = rays.jacobian(aim, row, column);
            const double fraction = rays.is_inner(row, column) ? 1.0 : aim.open_fraction(*aimed, slope, spacing);
            if (!(fraction > 0.0)) {
                continue;
            }
            (slope.determinant() < 0.0 ? turned : straight) += 1;
            const double area = 1.0 / std::abs(slope.determinant());
            const std::size_t cell = pupil.cell(row, column);
            pupil.fraction[cell] = fraction;
            pupil.amplitude[cell] = fraction * std::sqrt(area);
            pupil.path[cell] = aimed->ray.path - mean_path;
            pupil.offset[cell] = aimed->offset;
            pupil.aberration[cell] = aimed->ray.aberration;
            pupil.energy += fraction * area * spacing * spacing;
            pupil.largest_aberration = std::max(pupil.largest_aberration, length(aimed->ray.aberration));
        }
    }
    if (pupil.energy > 0.0) {
        const bool is_seen = pupil.largest_aberration <= pupil.largest_seen_aberration();
        pupil.status = turned > 0 && straight > 0 ? PupilStatus::folded
                       : is_seen                  ? PupilStatus::ok
                                                  : PupilStatus::aliased;
    }
    return pupil;
}

SampledPupil refocused(SampledPupil pupil, const PolychromaticField& field, double shift) {
    const Vec3d& chief = field.chief_direction;
    const Vec3d move = (shift / chief.z) * chief;
    const double chief_path = dot(chief, move);
    pupil.largest_aberration = 0.0;
    for (int row = 0; row < pupil.size; ++row) {
        for (int column = 0; column < pupil.size; ++column) {
            const std::size_t cell = pupil.cell(row, column);
            if (!(pupil.amplitude[cell] > 0.0)) {
                continue;
            }
            const Vec2d cosines = pupil.cosines(row, column);
            const double z = std::copysign(std::sqrt(dot(chief, chief) - dot(cosines, cosines)), chief.z);
            pupil.path[cell] += cosines.x * move.x + cosines.y * move.y + z * move.z - chief_path;
            Vec2d& aberration = pupil.aberration[cell];
            aberration = {aberration.x + shift * cosines.x / z - move.x, aberration.y + shift * cosines.y / z - move.y};
            pupil.largest_aberration = std::max(pupil.largest_aberration, length(aberration));
        }
    }
    if (pupil.status == PupilStatus::ok || pupil.status == PupilStatus::aliased) {
        pupil.status =
            pupil.largest_aberration <= pupil.largest_seen_aberration() ? PupilStatus::ok : PupilStatus::aliased;
    }
    return pupil;
}

std::vector<std::complex<double>> pupil_function(const SampledPupil& pupil, bool is_perfect) {
    const double wavenumber = 2.0 * std::numbers::pi / (1e-6 * pupil.wavelength_nm);
    std::vector<std::complex<double>> function(pupil.amplitude.size());
    for (std::size_t i = 0; i < function.size(); ++i) {
        function[i] = is_perfect ? pupil.amplitude[i] : std::polar(pupil.amplitude[i], wavenumber * pupil.path[i]);
    }
    return function;
}

}  // namespace lensproof::analysis
