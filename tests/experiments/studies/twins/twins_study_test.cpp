#include "experiments/studies/twins/twins_study.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "engine/base/file.h"
#include "engine/base/input_error.h"
#include "engine/base/write_file.h"
#include "engine/formats/image/image.h"
#include "experiments/runner/experiment.h"
#include "tests/calibration/synthetic.h"
#include "tests/complaint.h"
#include "tests/tessar_photos.h"
#include "tests/test_folder.h"

namespace lensproof::studies::twins_study_test {
namespace {

constexpr int kPhotos = 5;

findings::Findings run(const std::filesystem::path& file) {
    findings::RunSettings settings;
    settings.self_test = false;
    return runner::run_experiment(runner::read_experiment(file), settings, [](const std::string&, double) {});
}

/// A camera that was never there, with a Tessar: five photos of a chart, 8 bits a channel.
class TwinsStudy : public testing::Test {
  protected:
    static void SetUpTestSuite() {
        folder_ = new TestFolder;
        write_file(folder_->path() / "camera.toml", tessar_photos(400, 64));
        const findings::Findings found = run(folder_->path() / "camera.toml");
        std::string photos;
        for (int i = 0; i < kPhotos; ++i) {
            const std::string name = fmt::format("{}.png", i + 1);
            write_file(folder_->path() / name, found.subjects.front().pictures[static_cast<std::size_t>(i)].bytes);
            photos += fmt::format("\"{}\", ", name);
        }
        write_file(folder_->path() / "manifest.toml",
                   fmt::format("name = \"n\"\nlicence = \"l\"\nsource = \"s\"\nphotos = [{}]\n[chart]\n{}", photos,
                               kTessarChart));
    }
    static void TearDownTestSuite() {
        delete folder_;
        folder_ = nullptr;
    }

    static std::filesystem::path experiment(const std::string& twins, const std::string& manifest = "manifest.toml") {
        std::filesystem::path file = folder_->path() / "twins.toml";
        write_file(file, fmt::format("title = \"t\"\n[[photos]]\nname = \"photos\"\nmanifest = \"{}\"\n"
                                     "model = \"brown-conrady\"\n[[twins]]\nname = \"twins\"\n{}",
                                     manifest, twins));
        return file;
    }

    static TestFolder* folder_;
};

TestFolder* TwinsStudy::folder_ = nullptr;

const findings::Check& check_of(const findings::Findings& found) {
    return *std::ranges::find(found.checks, "twins-lens", &findings::Check::id);
}

TEST_F(TwinsStudy, ALensAgreesWithPhotosThroughItself) {
    const findings::Findings found =
        run(experiment("photos = \"photos\"\nlens = \"tessar\"\nf_number = 11.0\nlimit_px = 0.05\n"));
    const findings::Check& check = check_of(found);
    EXPECT_EQ(check.verdict(), findings::Verdict::pass) << check.value << " ± " << check.sigma;
    const Json& table = found.tables.back().second;
    ASSERT_EQ(found.tables.back().first, "twins");
    // The pixel pitch that nobody stated: 0.24 mm. The camera model's focal length is known to some 1e-3 of itself.
    EXPECT_NEAR(table[0]["pixel_pitch_um"].number(), 240.0, 1.0);
    const auto subject = std::ranges::find(found.subjects, "twins", &findings::Subject::id);
    ASSERT_EQ(subject->pictures.size(), kPhotos);
    EXPECT_FALSE(subject->pictures.front().bytes.empty());
}

TEST_F(TwinsStudy, AnotherLensDoesNot) {
    const findings::Findings found =
        run(experiment("photos = \"photos\"\nlens = \"muller-fisheye\"\nf_number = 11.0\nlimit_px = 0.05\n"));
    EXPECT_EQ(check_of(found).verdict(), findings::Verdict::fail) << check_of(found).value;
}

TEST_F(TwinsStudy, PhotosTooPoorToSayAreInconclusive) {
    calibration::synthetic::Noise noise(1);
    std::filesystem::create_directory(folder_->path() / "noisy");
    for (int i = 1; i <= kPhotos; ++i) {
        formats::Image image = formats::read_image(folder_->path() / fmt::format("{}.png", i));
        for (float& value : image.pixels) {
            value = std::clamp(value + static_cast<float>(0.08 * noise()), 0.0F, 1.0F);
        }
        formats::write_png(image, folder_->path() / "noisy" / fmt::format("{}.png", i));
    }
    const std::string manifest = read_file(folder_->path() / "manifest.toml");
    write_file(folder_->path() / "noisy" / "manifest.toml", manifest);
    const findings::Findings found = run(experiment(
        "photos = \"photos\"\nlens = \"tessar\"\nf_number = 11.0\nlimit_px = 0.01\n", "noisy/manifest.toml"));
    EXPECT_EQ(check_of(found).verdict(), findings::Verdict::inconclusive)
        << check_of(found).value << " ± " << check_of(found).sigma;
}

TEST_F(TwinsStudy, NamesWhatItCannotUse) {
    // Of the file, which nothing is done with, or of the study, whose failure is among the findings.
    const auto complaint = [&](const std::string& twins) {
        std::string failures;
        const std::string refusal = complaint_about([&] {
            for (const findings::Failure& failure : run(experiment(twins)).failures) {
                failures += failure.message;
            }
        });
        return refusal + failures;
    };
    EXPECT_TRUE(says(complaint("photos = \"phtos\"\nlens = \"tessar\"\n"), "phtos"));
    EXPECT_TRUE(says(complaint("photos = \"phtos\"\nlens = \"tessar\"\n"), "a [[photos]] of this file: photos"));
    EXPECT_TRUE(says(complaint("photos = \"photos\"\nlens = \"tesar\"\n"), "tessar"));
    EXPECT_TRUE(says(complaint("photos = \"photos\"\nlens = \"tessar\"\n"), "state no f-number, expected f_number"));
    EXPECT_TRUE(says(complaint("photos = \"photos\"\nlens = \"tessar\"\nf_number = 11.0\nfit = [\"focs\"]\n"), "focs"));
    EXPECT_TRUE(says(complaint("photos = \"photos\"\nlens = \"tessar\"\nf_number = 0.5\n"), "f/"));
    EXPECT_TRUE(says(complaint("photos = \"photos\"\nlens = \"tessar\"\nsample = 3\n"), "sample"));
}

}  // namespace
}  // namespace lensproof::studies::twins_study_test
