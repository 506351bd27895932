#include "engine/optics/texture_edges.h"

#include <gtest/gtest.h>

#include <cmath>

#include "engine/base/angle.h"
#include "engine/base/infinity.h"
#include "engine/optics/stop_mask.h"

namespace lensproof::optics::texture_edges_test {

/// A picture of what is open, each texel its mean.
template <class Open>
ApertureTexture picture(int columns, int rows, const Open& open) {
    ApertureTexture texture{.size_x = columns, .size_y = rows, .values = {}};
    constexpr int kFine = 8;
    for (int row = 0; row < rows; ++row) {
        for (int column = 0; column < columns; ++column) {
            int inside = 0;
            for (int i = 0; i < kFine * kFine; ++i) {
                const double x = 2.0 * (column + (i % kFine + 0.5) / kFine) / columns - 1.0;
                const int down = i / kFine;
                const double y = 1.0 - 2.0 * (row + (down + 0.5) / kFine) / rows;
                inside += open(Vec2d{x, y}) ? 1 : 0;
            }
            texture.values.push_back(static_cast<float>(inside) / (kFine * kFine));
        }
    }
    return texture;
}

StopMask mask_of(const ApertureTexture& texture) {
    const TexturedStop shape{.image = "", .texture = std::make_shared<const ApertureTexture>(texture)};
    return StopMask(StopShape{shape}).with_edges();
}

// Six blades, 10° turned: six straight edges with their normals to a tenth of a degree and their length to a texel.
TEST(TextureEdges, OfAPolygonAreItsSides) {
    const StopMask stated(StopShape{PolygonStop{.blades = 6, .rotation_deg = 10.0}});
    const ApertureTexture texture =
        picture(256, 256, [&](const Vec2d& at) { return length(at) < 1.0 && stated.transmittance(at.x, at.y) > 0.0; });
    const auto pieces = texture_edges(texture);
    ASSERT_TRUE(pieces);
    int sides = 0;
    for (const EdgePiece& piece : *pieces) {
        if (piece.piece_length() < 0.5) {
            continue;  // a corner's
        }
        ++sides;
        EXPECT_NEAR(piece.edge_length, 1.0, 4.0 / 128.0);
        EXPECT_EQ(piece.outward_from, piece.outward_to);
        const double turn =
            std::remainder(degrees(std::atan2(piece.outward_from.y, piece.outward_from.x)) - 40.0, 60.0);
        EXPECT_NEAR(turn, 0.0, 0.1);
    }
    EXPECT_EQ(sides, 6);
    const StopMask pictured = mask_of(texture);
    EXPECT_NEAR(pictured.perimeter(), stated.perimeter(), 0.01 * stated.perimeter());
    EXPECT_NEAR(pictured.area(), stated.area(), 0.01 * stated.area());
    const auto near = pictured.edges_near(0.8 * std::cos(radians(40.0)), 0.8 * std::sin(radians(40.0)), 0.1);
    ASSERT_EQ(near.size(), 1U);
    EXPECT_NEAR(near[0].distance, std::cos(radians(30.0)) - 0.8, 0.5 / 128.0);
}

// Of a ring, in texels that are twice as wide as high: normals are radial everywhere, inwards on the inner circle, and
// what has no corners has no length.
TEST(TextureEdges, OfARingTurnAllAround) {
    const StopMask ring =
        mask_of(picture(200, 400, [](const Vec2d& at) { return length(at) < 1.0 && length(at) > 0.4; }));
    ASSERT_TRUE(ring.has_edges());
    EXPECT_NEAR(ring.perimeter(), 2.0 * kPi * 1.4, 0.01 * 2.0 * kPi * 1.4);
    EXPECT_NEAR(ring.area(), kPi * (1.0 - 0.16), 0.01 * kPi);
    constexpr int kPoints = 1000;
    int outer = 0;
    for (int i = 0; i < kPoints; ++i) {
        const StopMask::EdgePoint at = ring.edge_at((i + 0.5) / kPoints);
        const double r = length(at.point);
        const bool is_outer = r > 0.7;
        outer += is_outer ? 1 : 0;
        EXPECT_NEAR(r, is_outer ? 1.0 : 0.4, 1.2 / 100.0);
        EXPECT_GT((is_outer ? 1.0 : -1.0) * dot(at.outward, at.point) / r, std::cos(radians(4.0))) << i;
        EXPECT_EQ(at.length, kInfinity);
    }
    EXPECT_NEAR(outer, kPoints / 1.4, 0.01 * kPoints);
    const auto inner = ring.edges_near(0.45, 0.0, 0.1);
    ASSERT_EQ(inner.size(), 1U);
    EXPECT_NEAR(inner[0].radius, -0.4, 0.1);
}

TEST(TextureEdges, OfSoftOrDarkPicturesAreNone) {
    ApertureTexture soft{.size_x = 64, .size_y = 64, .values = {}};
    for (int i = 0; i < 64 * 64; ++i) {
        soft.values.push_back(static_cast<float>(i % 64) / 64.0F);
    }
    EXPECT_FALSE(texture_edges(soft));
    EXPECT_FALSE(texture_edges({.size_x = 8, .size_y = 8, .values = std::vector<float>(64, 0.0F)}));
    EXPECT_FALSE(texture_edges({.size_x = 1, .size_y = 1, .values = {1.0F}}));
    ApertureTexture noise{.size_x = 64, .size_y = 64, .values = {}};
    for (unsigned i = 0; i < 64 * 64; ++i) {
        noise.values.push_back(static_cast<float>((i * 2654435761U) >> 31U));
    }
    EXPECT_FALSE(texture_edges(noise));
    // Open everywhere: the circle's own.
    constexpr std::size_t kTexels = 64;
    const auto open =
        texture_edges({.size_x = 64, .size_y = 64, .values = std::vector<float>(kTexels * kTexels, 1.0F)});
    ASSERT_TRUE(open);
    EXPECT_NEAR(open->back().before + open->back().piece_length(), 2.0 * kPi, 0.1);
}

}  // namespace lensproof::optics::texture_edges_test
