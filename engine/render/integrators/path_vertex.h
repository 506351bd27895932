// engine/render/integrators/path_vertex.h — what paths from either end have in common.
#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "engine/base/basis.h"
#include "engine/render/integrators/shading_frame.h"
#include "engine/render/sampling/path_sampler.h"
#include "engine/scene/scene.h"

namespace lensproof::render {

struct PathSettings {
    int max_bounces = 8;  // scatterings on a path; 0 shows lights alone
    int min_bounces = 0;  // 0 or 1: the latter leaves out light that comes straight from its source
    /// With the latter: but for what of the sky's light falls to camera paths (`sky_by_camera`).
    bool takes_sky_by_camera = false;
    /// Of paths whose first surface sends them one way only: a mirror, smooth glass.
    bool begins_at_mirror = false;
    /// Light that comes straight from a sun is left out: another pass has it (`waves`).
    bool leaves_suns_out = false;
    /// From this bounce on, paths are ended at random by how little they still carry ("Russian roulette", Arvo & Kirk,
    /// SIGGRAPH 1990): one goes on with the probability of its root, and carries more for it.
    int roulette_from = 3;
};

/// A surface point on a path, with its scattering at the path's wavelengths.
struct PathVertex {
    const scene::SurfaceHit& hit;
    Vec3d backwards;       // world, towards where the path comes from
    Basis frame;           // z: the shading normal
    bool is_bent;          // it, for a camera there
    Vec3d wo;              // local, towards where the path comes from
    double cos_backwards;  // |cos| of that about the geometric normal
    scene::Bsdf bsdf;

    /// `backwards`: world, unit length, towards where the path comes from. Hit and scene outlive the vertex.
    PathVertex(const scene::SurfaceHit& at, const Vec3d& backwards_, const scene::Scene& scene,
               const spectral::PathWavelengths& path)
        : hit(at),
          backwards(backwards_),
          frame(at.shading_normal, at.tangent),
          is_bent(bend(frame, at, backwards)),
          wo(frame.to_local(backwards)),
          cos_backwards(std::abs(dot(backwards, at.geometric_normal))),
          bsdf(scene::bsdf_at(scene.materials[at.material], at.uv, path)) {}

    /// Whether a direction lies on the same side of the surface by its shading normal as by its geometry: where they
    /// differ light would leak through.
    [[nodiscard]] bool is_consistent(const Vec3d& world, const Vec3d& local) const {
        return dot(world, hit.geometric_normal) * local.z > 0.0;
    }

    /// What of light from a direction (world, unit length) goes back along the path, the cosine included.
    [[nodiscard]] spectral::SpectralSample scattering(const Vec3d& from) const {
        const Vec3d wi = frame.to_local(from);
        return is_consistent(from, wi) ? scene::evaluate(bsdf, wo, wi, scene::Transport::radiance)
                                       : spectral::SpectralSample();
    }

    /// Both directions in the frame of a path that comes from `onwards`, whose local direction here is `wi`.
    struct Seen {
        Vec3d onwards;
        Vec3d backwards;
        bool is_bent = false;  // the normal, from one of both: a mirror then sends paths from them different ways
    };
    [[nodiscard]] Seen as_from(const Vec3d& onwards, const Vec3d& wi) const {
        Basis other(hit.shading_normal, hit.tangent);
        if (!bend(other, hit, onwards) && !is_bent) {
            return {wi, wo};
        }
        return {other.to_local(onwards), other.to_local(backwards), true};
    }

    /// A direction that a path from a light goes on in, in the frame of one that comes from there.
    struct Turn {
        std::optional<scene::BsdfSample> bsdf;  // nothing: the path ends
        Vec3d onwards;                          // world
        Vec3d wo;                               // local, where the path came from
    };
    [[nodiscard]] Turn turn_from_light(const scene::BsdfNumbers& numbers) const {
        Turn turn{.bsdf = scene::sample(bsdf, wo, numbers, scene::Transport::importance), .wo = wo};
        if (turn.bsdf) {
            turn.onwards = frame.to_world(turn.bsdf->wi);
            if (const Seen seen = as_from(turn.onwards, turn.bsdf->wi); seen.is_bent) {
                bend_turn(seen, turn);
            } else if (!is_consistent(turn.onwards, turn.bsdf->wi)) {
                turn.bsdf.reset();
            }
        }
        return turn;
    }

  private:
    /// What was drawn in its own frame is weighed in that of the camera's side.
    void bend_turn(const Seen& seen, Turn& turn) const {
        if (turn.bsdf->is_delta || !is_consistent(turn.onwards, seen.onwards) ||
            !is_consistent(backwards, seen.backwards)) {
            turn.bsdf.reset();
            return;
        }
        turn.bsdf->wi = seen.onwards;
        turn.bsdf->weight = static_cast<float>(1.0 / turn.bsdf->pdf) *
                            scene::evaluate(bsdf, seen.backwards, seen.onwards, scene::Transport::importance);
        turn.wo = seen.backwards;
    }
};

/// The transmittance of the body that light has come through to its surface from inside; 1 through the open.
inline spectral::SpectralSample body_transmittance(const scene::Scene& scene, const scene::SurfaceHit& hit,
                                                   const Vec3d& direction, const spectral::PathWavelengths& path) {
    if (scene.absorption.empty() || dot(hit.geometric_normal, direction) <= 0.0 || !scene.absorption[hit.material]) {
        return spectral::SpectralSample(1.0F);
    }
    const auto distance_mm = static_cast<float>(hit.distance_mm);
    return spectral::for_each_wavelength([&](float per_mm) { return std::exp(-per_mm * distance_mm); },
                                         (*scene.absorption[hit.material])(path));
}

/// Whether a path that carries `carries`, having started with 1, goes on after a bounce; scales what does.
inline bool survives_roulette(const PathSettings& settings, int bounce, double number,
                              spectral::SpectralSample& carries) {
    const float largest = spectral::max_value(carries);
    if (!(largest > 0.0F)) {
        return false;
    }
    if (bounce < settings.roulette_from || largest >= 1.0F) {
        return true;
    }
    // The root: by all that is left, what ends would cost less than the noise that its ending makes.
    const float survival = std::max(std::sqrt(largest), 0.05F);
    carries *= 1.0F / survival;
    return number < survival;
}

}  // namespace lensproof::render
