#include "engine/formats/image/confined_picture.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <vector>

#include "engine/base/confined.h"
#include "engine/base/data_root.h"
#include "engine/base/input_error.h"

namespace lensproof::formats::confined_picture_test {

/// What can be seen of a picture, of all its parts; or why it cannot be read.
template <class Open>
std::string seen(const std::filesystem::path& file, const Open& open) {
    std::string all;
    try {
        const OpenPicture picture = open(file, OIIO::ImageSpec());
        OIIO::ImageInput& input = *picture.input;
        for (int part = 0; input.seek_subimage(part, 0) && part < 4; ++part) {
            OIIO::ImageSpec spec = input.spec();
            check_picture_size(file, spec, spec.nchannels, 4.0 * spec.nchannels);
            std::vector<float> pixels(static_cast<std::size_t>(spec.width) * spec.height * spec.nchannels);
            all += input.read_image(part, 0, 0, spec.nchannels, OIIO::TypeDesc::FLOAT, pixels.data()) ? "read" : "not";
            all += on_one_line(input.geterror());
            all.append(reinterpret_cast<const char*>(pixels.data()), sizeof(float) * pixels.size());
            spec.tile_width = spec.tile_height = spec.tile_depth = 0;
            all += spec.to_xml();
        }
    } catch (const InputError& error) {
        all += error.what();
    }
    return all;
}

// Of every kind of file that has attacked the readers, and of sound ones with tiles, several parts, all compressions.
TEST(ConfinedPicture, IsTheOneThatIsDecodedHere) {
    GTEST_FLAG_SET(death_test_style, "threadsafe");
    EXPECT_EXIT(
        {
            distrust_files();
            int compared = 0;
            for (const auto& entry : std::filesystem::directory_iterator(data_root() / "tests/fuzz/corpus/picture")) {
                EXPECT_EQ(seen(entry.path(), open_confined), seen(entry.path(), open_picture_here)) << entry.path();
                ++compared;
            }
            EXPECT_GT(compared, 20);
            std::_Exit(testing::Test::HasFailure() ? 1 : 0);
        },
        testing::ExitedWithCode(0), "");
}

}  // namespace lensproof::formats::confined_picture_test
