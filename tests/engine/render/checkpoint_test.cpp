#include "engine/render/checkpoint.h"

#include <gtest/gtest.h>

#include <atomic>
#include <utility>
#include <vector>

#include "engine/base/file.h"
#include "engine/base/input_error.h"
#include "engine/base/write_file.h"
#include "tests/complaint.h"
#include "tests/engine/render/film/film_sample.h"
#include "tests/test_folder.h"

namespace lensproof::render::checkpoint_test {

const RenderIdentity kIdentity = {{"scene", "abc"}, {"lens", "def"}};

/// A render of 40 × 20 pixels with everything that a film may have, and how it goes on.
class SmallRender {
  public:
    [[nodiscard]] RenderState begin(std::uint32_t samples) const { return {layout_, {.first = 0, .end = samples}}; }

    void go_on(RenderState& state, int most_tiles) const {
        std::atomic<int> tiles = 0;
        render_progressively(state, exponential_renderer(layout_, 1), {},
                             {.threads = 1, .is_interrupted = [&] { return ++tiles > most_tiles; }});
    }

  private:
    FilmLayout layout_ = full_film(40, 20, 3);
};

std::string file_of(const RenderState& state) {
    const TestFolder folder;
    write_checkpoint(folder.path() / "c", kIdentity, {&state, 1});
    return read_file(folder.path() / "c");
}

std::string refusal(const std::filesystem::path& file, const RenderIdentity& identity, RenderState& state) {
    return complaint_about([&] { read_checkpoint(file, identity, {&state, 1}); });
}

TEST(Checkpoint, HoldsEveryBitOfARender) {
    const TestFolder folder;
    const SmallRender render;
    RenderState whole = render.begin(100);
    render.go_on(whole, 1000);
    RenderState state = render.begin(100);
    render.go_on(state, 8);  // in the midst of the second round
    write_checkpoint(folder.path() / "c", kIdentity, {&state, 1});
    RenderState read = render.begin(100);
    read_checkpoint(folder.path() / "c", kIdentity, {&read, 1});
    EXPECT_EQ(file_of(read), file_of(state));
    render.go_on(read, 1000);
    EXPECT_EQ(file_of(read), file_of(whole));
}

TEST(Checkpoint, HoldsEveryPass) {
    const TestFolder folder;
    const SmallRender render;
    const auto begin = [&] {
        std::vector<RenderState> passes = {render.begin(32), render.begin(32)};
        passes[0].pass = "imaged";
        passes[1].pass = "ghosts";
        return passes;
    };
    std::vector<RenderState> passes = begin();
    render.go_on(passes[1], 3);
    write_checkpoint(folder.path() / "c", kIdentity, passes);
    std::vector<RenderState> read = begin();
    read_checkpoint(folder.path() / "c", kIdentity, read);
    EXPECT_EQ(file_of(read[0]), file_of(passes[0]));
    EXPECT_EQ(file_of(read[1]), file_of(passes[1]));
    EXPECT_NE(file_of(read[0]), file_of(read[1]));
    // Of other passes it is another render's.
    std::swap(read[0], read[1]);
    EXPECT_THROW(read_checkpoint(folder.path() / "c", kIdentity, read), InputError);
    read.pop_back();
    EXPECT_THROW(read_checkpoint(folder.path() / "c", kIdentity, read), InputError);
}

// Cut anywhere, or with any bit turned, it is refused, and the state that wanted it stands as it was.
TEST(Checkpoint, IsRefusedWhereDamaged) {
    const TestFolder folder;
    const std::filesystem::path file = folder.path() / "c";
    const SmallRender render;
    RenderState state = render.begin(16);
    render.go_on(state, 1000);
    const std::string good = file_of(state);
    RenderState fresh = render.begin(16);
    const std::string before = file_of(fresh);
    std::vector<std::string> bad = {"", "lensproof", "lensproof checkpoint\n", good + "x", good.substr(1)};
    for (const double fraction : {0.0001, 0.001, 0.01, 0.1, 0.5, 0.9, 0.99999}) {
        const auto at = static_cast<std::size_t>(fraction * static_cast<double>(good.size()));
        bad.push_back(good.substr(0, at));
        bad.push_back(good);
        bad.back()[at] = static_cast<char>(bad.back()[at] ^ 4);
    }
    for (const std::string& content : bad) {
        write_file(file, content);
        EXPECT_NE(refusal(file, kIdentity, fresh).find(file.string()), std::string::npos);
        EXPECT_EQ(file_of(fresh), before);
    }
}

TEST(Checkpoint, OfAnotherRenderIsRefusedWithTheDifferenceNamed) {
    const TestFolder folder;
    const std::filesystem::path file = folder.path() / "c";
    const SmallRender render;
    RenderState state = render.begin(100);
    render.go_on(state, 1000);
    write_checkpoint(file, kIdentity, {&state, 1});
    RenderState fresh = render.begin(100);
    EXPECT_NE(refusal(file, {{"scene", "abc"}, {"lens", "xyz"}}, fresh).find("its lens is def, expected xyz"),
              std::string::npos);
    EXPECT_NE(refusal(file, {{"scene", "abc"}, {"seed", "1"}}, fresh).find("no seed"), std::string::npos);
    RenderState other_film(plain_film(40, 21, 3), {.first = 0, .end = 100});
    EXPECT_NE(refusal(file, kIdentity, other_film).find("another size"), std::string::npos);
    RenderState other_part(render.begin(100).film.layout(), {.first = 50, .end = 100});
    EXPECT_NE(refusal(file, kIdentity, other_part).find("begin at 0, expected 50"), std::string::npos);
    RenderState shorter = render.begin(99);
    EXPECT_NE(refusal(file, kIdentity, shorter).find("100 samples a pixel already"), std::string::npos);
    RenderState longer = render.begin(200);
    read_checkpoint(file, kIdentity, {&longer, 1});
    EXPECT_EQ(longer.tiles[0], (TileProgress{.done = 100, .target = 100}));
    EXPECT_EQ(longer.range.end, 200U);
}

}  // namespace lensproof::render::checkpoint_test
