// engine/render/integrators/mis_weight.h — how much a path counts that camera paths and light paths both can make.
//
// A path of light from a source over the surface points x_n, …, x_1 to the camera can come about by three techniques:
//
//   hit     a camera path scatters at each of its points and runs into the light,
//   sample  a camera path reaches x_n and samples the light from there (next-event estimation),
//   join    a light path scatters until x_1 and is joined to the camera.
//
// Each is counted with its MIS weight by the power heuristic, p² / (p_hit² + p_sample² + p_join²) with its own pdf p
// (Veach & Guibas, SIGGRAPH 1995, β = 2; one path a technique), so that the weights sum to one and each path counts
// once; a technique that cannot make the path has p = 0. (The balance heuristic would let light paths add more of their
// noise where camera paths have hardly any, at a lamp in view: 1.65 times the variance in
// `BothPaths.AreNoNoisierThanTheBetter`.) The ratios grow point by point as a path goes, as in I. Georgiev,
// "Implementing Vertex Connection and Merging" (2012), for these three of its techniques. With pdfs per etendue and per
// projected solid angle all distances cancel:
//
//   p_join / p_hit = leaving · (entrance / cos_1) · j_2 … j_n / (drawn · c_1 … c_n),
//
// `leaving` being the pdf with which light paths leave the source, c_i that with which a camera path turns towards the
// light at x_i and j_i that with which a light path turns towards the camera, both about the geometric normal,
// `entrance` that per solid angle of the ray which joins x_1 to the camera, at the cosine cos_1 from x_1's normal, and
// `drawn` the one with which the camera draws it. p_sample is p_hit with the light's pdf from x_n in the place of c_n.
//
// Mirrors and smooth glass: their turns have the same probability from both sides and count as ratios of 1, so does the
// n² by which glass squeezes etendue, which a path that leaves the glass again returns. x_1 there cannot be joined,
// x_n cannot sample. Roulette is left out. Whatever is left out, or is a stand-in for a pdf, costs noise alone: weights
// sum to one wherever both kinds of path compute the same numbers from the path's own points, which is all that freedom
// from bias asks for (`MisWeight.WeightsOfAPathSumToOne`).
#pragma once
#include <cmath>
#include <numbers>

#include "engine/render/camera/camera.h"
#include "engine/render/integrators/path_vertex.h"
#include "engine/scene/light/light.h"

namespace lensproof::render {

/// What camera paths count of light that comes straight from infinity, where paths of both ends go through the lens by
/// chance and theirs have no pdf; light paths, which draw the direction with `start_pdf` (1/sr), count the rest. Any
/// weights that add up to one are right: these give an even sky to camera paths, a sun to light paths.
inline double sky_by_camera(double start_pdf) {
    constexpr double kHalf = 10.0 / (4.0 * std::numbers::pi);  // ten times as likely as in an even sky
    const double ratio = start_pdf / kHalf;
    return 1.0 / (1.0 + ratio * ratio);
}

/// A path's turn at a surface point.
struct PathTurn {
    double to_light = 0.0;   // pdf per solid angle with which a camera path turns to the light's side
    double to_camera = 0.0;  // and a light path to the camera's
    double cos_light = 1.0;  // |cos| of these directions about the geometric normal
    double cos_camera = 1.0;
    bool is_delta = false;              // at a mirror or smooth glass, without pdfs
    bool is_from_camera_alone = false;  // one that light paths do not make (shading_frame.h)
};

/// The turn at a vertex of a camera path, which goes on along `onwards` (world) and `wi` (local) with the pdf
/// `to_light`.
inline PathTurn camera_turn(const PathVertex& vertex, const Vec3d& onwards, const Vec3d& wi, double to_light) {
    const PathVertex::Seen seen = vertex.as_from(onwards, wi);
    return {.to_light = to_light,
            .to_camera = scene::pdf(vertex.bsdf, seen.onwards, seen.backwards, scene::Transport::importance),
            .cos_light = std::abs(dot(onwards, vertex.hit.geometric_normal)),
            .cos_camera = vertex.cos_backwards};
}

/// The same of a light path, whose own pdf is `to_camera`.
inline PathTurn light_turn(const PathVertex& vertex, const Vec3d& onwards, const Vec3d& wi, double to_camera) {
    const PathVertex::Seen seen = vertex.as_from(onwards, wi);
    return {.to_light = scene::pdf(vertex.bsdf, seen.onwards, seen.backwards, scene::Transport::radiance),
            .to_camera = to_camera,
            .cos_light = vertex.cos_backwards,
            .cos_camera = std::abs(dot(onwards, vertex.hit.geometric_normal))};
}

/// The MIS weight of a technique by the power heuristic, from the ratios of the others' pdfs to its own.
inline double power_heuristic(double one, double other) {
    return 1.0 / (1.0 + one * one + other * other);
}

/// The MIS weights of what a camera path finds.
class CameraMisWeight {
  public:
    /// Of the first point; before anything else.
    void enter(const EntranceRatio& entrance) {
        entrance_ = entrance;
        by_light_ = 1.0;
    }

    void hero_goes_alone() { is_hero_alone_ = true; }

    void turn(const PathTurn& at) {
        if (at.is_delta) {
            by_light_ *= is_first_ || at.is_from_camera_alone ? 0.0 : 1.0;
        } else {
            by_light_ *= arrives(at) * at.cos_light / at.to_light;
        }
        sampled_ = at.is_delta ? 0.0 : 1.0 / at.to_light;
        is_first_ = false;
    }

    /// Of light that the path ran into, at `cosine` from its normal (1 of light from far off).
    [[nodiscard]] double of_hit(const scene::Lights::Emission& light, double cosine) const {
        const double joined = entrance() * (is_first_ ? light.start_pdf / cosine : light.leaving_pdf);
        return power_heuristic(light.pdf * sampled_, by_light_ * joined);
    }

    /// Of light that was sampled, through the turn `at`.
    [[nodiscard]] double of_sample(const scene::LightSample& light, const PathTurn& at) const {
        const double hit = light.pdf > 0.0 ? at.to_light / light.pdf : 0.0;
        const double joined = by_light_ * entrance() * arrives(at) * at.cos_light * light.leaving_per_sample;
        return power_heuristic(hit, joined);
    }

  private:
    [[nodiscard]] double entrance() const { return is_hero_alone_ ? entrance_.hero : entrance_.shared; }
    [[nodiscard]] double arrives(const PathTurn& at) const { return (is_first_ ? 1.0 : at.to_camera) / at.cos_camera; }

    EntranceRatio entrance_;
    double by_light_ = 0.0;  // p_join / p_hit but for the light's and the entrance's part; 0 without an entrance
    double sampled_ = 0.0;   // p_sample / p_hit but for the light's pdf
    bool is_first_ = true;
    bool is_hero_alone_ = false;
};

/// The MIS weight of what a light path brings to the camera. Its joints are told of 1 / EntranceRatio, since the
/// camera's pdf may be 0.
class LightMisWeight {
  public:
    /// Of the light, when the first surface is found.
    void leave(const scene::FirstSegment& segment) {
        hit_ = segment.hit_per_leaving;
        sampled_ = segment.sample_per_leaving;
    }

    void turn(const PathTurn& at) {
        if (at.is_delta) {
            sampled_ = is_first_ ? 0.0 : sampled_;
        } else {
            hit_ *= hits(at) * at.cos_camera / at.to_camera;
            sampled_ *= samples(at) * at.cos_camera / at.to_camera;
        }
        is_first_ = false;
    }

    /// The others' pdfs against that of a joint through the turn `at`, the root of the sum of their squares, but
    /// for the entrance's part.
    [[nodiscard]] double others(const PathTurn& at) const {
        return std::hypot(hit_ * hits(at), sampled_ * samples(at)) * at.cos_camera;
    }

    /// The same for light that goes straight from its source to the camera, at `cosine` from its normal (1 from far).
    [[nodiscard]] static double others(const scene::LightStart& start, double cosine) { return cosine / start.pdf; }

    [[nodiscard]] static double weight(double others, double drawn_per_entrance) {
        return power_heuristic(others * drawn_per_entrance, 0.0);
    }

  private:
    [[nodiscard]] static double hits(const PathTurn& at) { return at.to_light / at.cos_light; }
    [[nodiscard]] double samples(const PathTurn& at) const { return (is_first_ ? 1.0 : at.to_light) / at.cos_light; }

    double hit_ = 0.0;      // p_hit / p_join, likewise
    double sampled_ = 0.0;  // p_sample / p_join
    bool is_first_ = true;
};

}  // namespace lensproof::render
