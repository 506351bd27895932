#include "engine/render/camera/lens_profile.h"

#include <gtest/gtest.h>

#include "engine/base/cache.h"
#include "engine/formats/prescription/load_lens.h"
#include "engine/optics/focus.h"
#include "tests/test_folder.h"

namespace lensproof::render::lens_profile_test {
namespace {

const std::vector<double> kThreeLines_nm = {450.0, 550.0, 650.0};
constexpr double kFilmRadius_mm = 20.0;

// Whoever reads it from the cache has the very bits that tracing gives.
TEST(LensProfile, ThatIsKeptIsTheOneThatWasTraced) {
    const TestFolder folder;
    const Cache cache(folder.path());
    const optics::Lens lens = optics::with_f_number(formats::load_lens("tessar"), 5.6);
    const std::string traced = traced_profile(lens, kThreeLines_nm, kFilmRadius_mm).serialized();
    for (int i = 0; i < 2; ++i) {
        EXPECT_EQ(kept_profile(cache, lens, kThreeLines_nm, kFilmRadius_mm).serialized(), traced);
    }
    const optics::Lens other = optics::with_f_number(formats::load_lens("tessar"), 8.0);
    EXPECT_NE(kept_profile(cache, other, kThreeLines_nm, kFilmRadius_mm).serialized(), traced);
    EXPECT_NE(kept_profile(cache, lens, kThreeLines_nm, 0.5 * kFilmRadius_mm).serialized(), traced);
}

TEST(LensProfile, IsReadWholeOrNotAtAll) {
    const optics::Lens lens = formats::load_lens("tessar");
    const std::string bytes = traced_profile(lens, {550.0}, kFilmRadius_mm).serialized();
    ASSERT_TRUE(LensProfile::deserialized(bytes));
    EXPECT_FALSE(LensProfile::deserialized(bytes + "x"));
    for (std::size_t length = 0; length < bytes.size(); length += 37) {
        EXPECT_FALSE(LensProfile::deserialized(bytes.substr(0, length))) << length;
    }
}

}  // namespace
}  // namespace lensproof::render::lens_profile_test
