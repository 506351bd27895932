#include "engine/render/film/film_exr.h"

#include <gtest/gtest.h>

#include <limits>

#include "engine/base/file.h"
#include "engine/base/input_error.h"
#include "engine/base/write_file.h"
#include "engine/formats/image/image.h"
#include "tests/engine/render/film/film_sample.h"
#include "tests/test_folder.h"

namespace lensproof::render::film_exr_test {

// Single precision: half an ulp of a mean is 6e-8 of it, and a few of these come together.
constexpr double kFloat = 3e-7;

const FilmNotes kNotes = {.identity = {{"scene", "abc"}, {"seed", "7"}},
                          .metadata = {{"lensproof:lens", "a lens"}, {"lensproof:shard", "1/2"}},
                          .colours = spectral::RgbSpace{{0.64, 0.33}, {0.3, 0.6}, {0.15, 0.06}, {0.3127, 0.329}}};

/// Samples [first, end) of a film of 70 × 33 pixels with everything that a film may have.
Film filled(std::uint32_t first, std::uint32_t end) {
    const FilmLayout layout = full_film(70, 33, 4);
    return film_of(layout, {.rect = {0, 0, 70, 33}, .first = first, .end = end}, [&](FilmTile& tile) {
        for (std::uint32_t pixel = 0; pixel < 70 * 33; ++pixel) {
            for (std::uint32_t i = first; i < end; ++i) {
                if (pixel == 0) {
                    tile.add(pixel, i, 0, std::numeric_limits<double>::quiet_NaN());  // is left out
                }
                tile.add(pixel, i, i % 4, exponential_number(1, pixel, i));
                tile.add_features(pixel,
                                  {.depth_mm = 1000.0 + i, .albedo_rgb = {0.5, 0.2, 0.1}, .normal = {0.6, 0.0, -0.8}});
            }
            const float light = static_cast<float>(exponential_number(2, pixel, first));
            const std::uint32_t row = pixel / 70;
            tile.begin_light_path();
            tile.splat(all_at(pixel % 70, row), std::array<std::uint16_t, 4>{0, 1, 2, 3},
                       std::array<float, 4>{light, light, 0.0F, light});
        }
        for (std::uint32_t i = 0; i < 100 * (end - first); ++i) {
            tile.begin_light_path();  // which brings nothing
        }
    });
}

void expect_near(const Vec3d& a, const Vec3d& b, double relative) {
    EXPECT_NEAR(a.x, b.x, relative * std::abs(b.x));
    EXPECT_NEAR(a.y, b.y, relative * std::abs(b.y));
    EXPECT_NEAR(a.z, b.z, relative * std::abs(b.z));
}

/// Values to `relative`; variances to a hundredth of that of the mean's square, below which they say nothing, too.
void expect_same(const Film& a, const Film& b, double relative) {
    std::vector<double> layers_a(4);
    std::vector<double> layers_b(4);
    for (int y = 0; y < b.height(); ++y) {
        for (int x = 0; x < b.width(); ++x) {
            expect_near(a.estimate(x, y).rgb, b.estimate(x, y).rgb, relative);
            expect_near(a.light_estimate(x, y).rgb, b.light_estimate(x, y).rgb, relative);
            expect_near(a.light_estimate(x, y).variance, b.light_estimate(x, y).variance, relative);
            EXPECT_EQ(a.counts(x, y).samples, b.counts(x, y).samples);
            EXPECT_EQ(a.counts(x, y).blocks, b.counts(x, y).blocks);
            EXPECT_NEAR(a.features(x, y).depth_mm, b.features(x, y).depth_mm, relative * 1000.0);
            expect_near(a.features(x, y).albedo_rgb, b.features(x, y).albedo_rgb, relative);
            expect_near(a.features(x, y).normal, b.features(x, y).normal, relative);
            a.layers(x, y, layers_a);
            b.layers(x, y, layers_b);
            for (std::size_t k = 0; k < 4; ++k) {
                EXPECT_NEAR(layers_a[k], layers_b[k], relative * layers_b[k]);
            }
        }
    }
    EXPECT_EQ(a.light_paths(), b.light_paths());
    EXPECT_EQ(a.left_out(), b.left_out());
    EXPECT_GT(a.left_out(), 0U);
}

TEST(FilmExr, HoldsAFilm) {
    const TestFolder folder;
    const Film film = filled(0, 50);
    write_film_exr(film, kNotes, folder.path() / "a.exr");
    write_film_exr(film, kNotes, folder.path() / "b.exr");
    EXPECT_EQ(read_file(folder.path() / "a.exr"), read_file(folder.path() / "b.exr"));
    const auto [films, notes] = read_film_exr(folder.path() / "a.exr");
    const Film& read = films.front().film;
    expect_same(read, film, kFloat);
    EXPECT_EQ(notes.identity, kNotes.identity);
    EXPECT_EQ(notes.metadata, kNotes.metadata);
    ASSERT_TRUE(notes.colours);
    EXPECT_FLOAT_EQ(static_cast<float>(notes.colours->white.y), 0.329F);
    for (int x = 0; x < 70; ++x) {  // the camera's part comes as a difference of floats
        expect_near(read.estimate(x, 5).variance, film.estimate(x, 5).variance, 10 * kFloat);
    }
}

// Whoever takes it for a picture gets its R, G and B.
TEST(FilmExr, IsAPictureToo) {
    const TestFolder folder;
    const Film film = filled(0, 20);
    write_film_exr(film, kNotes, folder.path() / "a.exr");
    const formats::Image image = formats::read_image(folder.path() / "a.exr");
    EXPECT_EQ(image.channels, (std::vector<std::string>{"R", "G", "B"}));
    EXPECT_EQ(image.at(69, 32, 2), static_cast<float>(film.estimate(69, 32).rgb.z));
    EXPECT_EQ(image.metadata.at("lensproof:lens"), "a lens");
}

// Files of parts add up to the whole to 1e-6, variances included: both are of the same blocks.
TEST(FilmExr, PartsAddUpToTheWhole) {
    const TestFolder folder;
    const auto through_file = [&](const Film& film) {
        write_film_exr(film, kNotes, folder.path() / "part.exr");
        return Film(read_film_exr(folder.path() / "part.exr").films.front().film);
    };
    Film sum = through_file(filled(48, 96));
    sum.merge(through_file(filled(0, 16)));
    sum.merge(through_file(filled(16, 48)));
    Film whole = filled(0, 16);
    whole.merge(filled(16, 48));
    whole.merge(filled(48, 96));
    expect_same(sum, whole, 1e-6);
    for (int x = 0; x < 70; ++x) {
        expect_near(sum.estimate(x, 7).variance, whole.estimate(x, 7).variance, 1e-5);
    }
}

// Its first parts are the sum of the passes, and each comes back.
TEST(FilmExr, HoldsPasses) {
    const TestFolder folder;
    const Film imaged = filled(0, 20);
    const Film ghosts = filled(20, 50);
    FilmNotes notes = kNotes;
    notes.has_digest = true;
    const Picture picture({{"imaged", &imaged}, {"ghosts", &ghosts}});
    write_film_exr(picture, notes, folder.path() / "a.exr");
    const formats::Image image = formats::read_image(folder.path() / "a.exr");
    EXPECT_EQ(image.at(69, 32, 2), static_cast<float>(imaged.estimate(69, 32).rgb.z + ghosts.estimate(69, 32).rgb.z));
    const FilmFile read = read_film_exr(folder.path() / "a.exr");
    ASSERT_EQ(read.films.size(), 2U);
    EXPECT_EQ(read.films[1].pass, "ghosts");
    expect_same(read.films[0].film, imaged, kFloat);
    expect_same(read.films[1].film, ghosts, kFloat);
    EXPECT_EQ(read.notes.metadata, kNotes.metadata);
    std::vector<double> sum(4);
    std::vector<double> first(4);
    std::vector<double> second(4);
    picture.layers(3, 4, sum);
    imaged.layers(3, 4, first);
    ghosts.layers(3, 4, second);
    EXPECT_DOUBLE_EQ(sum[1], first[1] + second[1]);
}

TEST(FilmExr, RefusesWhatItDidNotWrite) {
    const TestFolder folder;
    const std::filesystem::path file = folder.path() / "a.exr";
    EXPECT_THROW(read_film_exr(file), InputError);
    formats::write_exr(formats::make_image(4, 3, {"R", "G", "B"}), file);
    EXPECT_THROW(read_film_exr(file), InputError);
    formats::write_png(formats::make_image(4, 3, {"R", "G", "B"}), folder.path() / "a.png");
    EXPECT_THROW(read_film_exr(folder.path() / "a.png"), InputError);
    write_film_exr(filled(0, 20), kNotes, file);
    const std::string good = read_file(file);
    for (const double fraction : {0.01, 0.1, 0.5, 0.9}) {
        write_file(file, good.substr(0, static_cast<std::size_t>(fraction * static_cast<double>(good.size()))));
        EXPECT_THROW(read_film_exr(file), InputError) << fraction;
    }
}

/// How many of a file's bytes with one bit turned make another film of it without a word.
int silent_damages(const FilmNotes& notes) {
    const TestFolder folder;
    const std::filesystem::path file = folder.path() / "a.exr";
    const Film film = exponential_film(8, 1, 0, 32);
    write_film_exr(film, notes, file);
    const std::string good = read_file(file);
    int silent = 0;
    for (std::size_t at = 0; at < good.size(); at += 3) {
        std::string damaged = good;
        damaged[at] = static_cast<char>(damaged[at] ^ 1);
        write_file(file, damaged, Durability::usual);
        try {
            const Film read = std::move(read_film_exr(file).films.front().film);
            bool is_same = read.width() == 8 && read.height() == 8;
            for (int i = 0; is_same && i < 64; ++i) {
                const auto [rgb, variance] = read.estimate(i % 8, i / 8);
                const auto [rgb_before, variance_before] = film.estimate(i % 8, i / 8);
                is_same = length(rgb - rgb_before) < 1e-6 && length(variance - variance_before) < 1e-6;
            }
            silent += is_same ? 0 : 1;
        } catch (const std::exception&) {  // NOLINT(bugprone-empty-catch): not silent
        }
    }
    return silent;
}

// Small films and noise do not shrink, and lie in the file as they are, without the sums of packed ones.
TEST(FilmExr, ADigestKnowsDamage) {
    EXPECT_GT(silent_damages({}), 0);
    EXPECT_EQ(silent_damages({.identity = {}, .metadata = {}, .colours = {}, .has_digest = true}), 0);
}

}  // namespace lensproof::render::film_exr_test
