// tests/engine/base/write_file_test.cpp — output files appear whole or not at all, and nobody else's is touched.
#include "engine/base/write_file.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/file.h>
#include <unistd.h>

#include <fstream>
#include <stdexcept>
#include <vector>

#include "engine/base/file.h"
#include "engine/base/input_error.h"
#include "tests/complaint.h"
#include "tests/test_folder.h"

namespace lensproof::write_file_test {

namespace fs = std::filesystem;

int files_in(const fs::path& folder) {
    return static_cast<int>(std::distance(fs::directory_iterator(folder), fs::directory_iterator()));
}

TEST(WriteFile, TheTemporaryFileIsNewAndGoesWithItsFailure) {
    const TestFolder folder;
    const fs::path file = folder.path() / "a.exr";
    write_file(file, "before");
    std::vector<fs::path> names;
    for (int i = 0; i < 2; ++i) {
        EXPECT_THROW(write_whole(file,
                                 [&](const fs::path& temporary) {
                                     EXPECT_EQ(fs::file_size(temporary), 0U);
                                     EXPECT_EQ(temporary.extension(), ".exr");
                                     names.push_back(temporary);
                                     std::ofstream(temporary) << "half";
                                     throw std::runtime_error("no more");
                                 }),
                     std::runtime_error);
    }
    EXPECT_NE(names[0], names[1]) << "a name that can be guessed can be taken";
    EXPECT_EQ(files_in(folder.path()), 1);
    EXPECT_EQ(read_file(file), "before");
}

// What a killed process left goes with the next file in the same folder; what a living one has locked, or is another's,
// stays. A link in its place is not followed.
TEST(WriteFile, LeftoversGo) {
    const TestFolder folder;
    const auto path = [&](const char* name) { return folder.path() / name; };
    const char* const kLeft = ".lensproof-0123456789abcdef.part.png";
    const char* const kLocked = ".lensproof-1123456789abcdef.part.png";
    const char* const kLink = ".lensproof-2123456789abcdef.part";
    const std::vector<const char*> kOthers = {".lensproof-3123456789abcdef.png",
                                              ".lensproof-4123456789abcdef.parts-list", ".lensproof-user.part.txt",
                                              "5.part", "target"};
    for (const char* name : kOthers) {
        std::ofstream(path(name)) << "x";
    }
    std::ofstream(path(kLeft)) << "x";
    std::ofstream(path(kLocked)) << "x";
    fs::create_symlink(path("target"), path(kLink));
    const int locked = ::open(path(kLocked).c_str(), O_RDWR | O_CLOEXEC);
    ASSERT_EQ(::flock(locked, LOCK_EX), 0);
    write_file(path("a"), "a");
    EXPECT_FALSE(fs::exists(path(kLeft)));
    EXPECT_TRUE(fs::exists(path(kLocked)));
    EXPECT_TRUE(fs::exists(path(kLink)));
    for (const char* name : kOthers) {
        EXPECT_TRUE(fs::exists(path(name))) << name;
    }
    EXPECT_EQ(read_file(path("target")), "x");
    ::close(locked);
}

TEST(WriteFile, WhatCannotBeWrittenIsKnownBefore) {
    const TestFolder folder;
    write_file(folder.path() / "file", "x");
    const auto refusal = [&](const fs::path& file) { return complaint_about([&] { check_output_name(file); }); };
    EXPECT_EQ(refusal(folder.path() / "new" / "folder" / "a.exr"), "");
    EXPECT_EQ(refusal("/dev/null"), "");
    EXPECT_TRUE(says(refusal(folder.path()), "is a folder"));
    EXPECT_TRUE(says(refusal(folder.path() / "file" / "a.exr"), "is a file, expected a folder"));
    EXPECT_TRUE(says(refusal(folder.path() / std::string(256, 'a')), "256 bytes, expected at most 255"));
    EXPECT_EQ(refusal(folder.path() / std::string(255, 'a')), "");
    EXPECT_TRUE(says(refusal("/proc/a.exr"), "/proc may not be written to"));  // not even by root
    std::string deep = folder.path().string();
    while (deep.size() < 4090) {
        deep += "/" + std::string(200, 'a');
    }
    EXPECT_TRUE(says(refusal(deep), "expected at most"));
    EXPECT_EQ(files_in(folder.path()), 1) << "asking leaves nothing";
}

TEST(WriteFile, AResultIsKeptWhereItCan) {
    const TestFolder folder;
    const auto path = [&](const char* name) { return folder.path() / name; };
    write_file(path("file"), "x");
    const auto write = [](const fs::path& place) { write_file(place, "result"); };
    EXPECT_EQ(write_somewhere({path("a"), path("b")}, write).place, path("a"));
    EXPECT_FALSE(fs::exists(path("b")));

    const Delivery second = write_somewhere({path("file/a"), path("file"), path("c")}, write);
    EXPECT_EQ(second.place, path("c")) << "what is there is somebody's";
    EXPECT_TRUE(says(second.complaint, "is a file, expected a folder"));
    EXPECT_EQ(read_file(path("file")), "x");

    const Delivery last = write_somewhere({path("file/a.exr")}, write);
    EXPECT_EQ(last.place.filename(), "a.exr");
    EXPECT_EQ(read_file(last.place), "result");
    fs::remove_all(last.place.parent_path());

    const auto refuse = [](const fs::path& place) { throw InputError("not " + place.filename().string()); };
    EXPECT_EQ(complaint_about([&] { write_somewhere({path("d"), path("e")}, refuse); }), "not d");
}

}  // namespace lensproof::write_file_test
