#include "engine/base/file.h"

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <fstream>
#include <thread>

#include "engine/base/write_file.h"
#include "tests/complaint.h"
#include "tests/test_folder.h"

namespace lensproof::file_test {

using namespace std::chrono_literals;

std::string complaint(const std::filesystem::path& file) {
    return complaint_about([&] { read_file(file); });
}

// Opening such a pipe in the usual way waits for a writer, for ever.
TEST(ReadFile, RefusesAPipeThatNothingIsWrittenTo) {
    const TestFolder folder;
    const std::filesystem::path pipe = folder.path() / "pipe.toml";
    ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
    EXPECT_TRUE(says(complaint(pipe), "pipe.toml: is a pipe that nothing is written to"));
}

// One that a program writes to, slowly and in pieces, is read to its end: `lensproof check <(cat lens.toml)`.
TEST(ReadFile, WaitsForAWriter) {
    const TestFolder folder;
    const std::filesystem::path pipe = folder.path() / "pipe.toml";
    ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
    std::array<int, 2> ends{};
    ASSERT_EQ(::pipe(ends.data()), 0);
    const std::filesystem::path substituted = "/dev/fd/" + std::to_string(ends[0]);
    const auto in_pieces = [](auto&& write) {
        std::this_thread::sleep_for(50ms);
        write("name");
        std::this_thread::sleep_for(50ms);
        write(" = 1");
    };
    std::ofstream named;
    std::thread opening([&] { named.open(pipe); });  // waits for a reader
    std::this_thread::sleep_for(50ms);
    std::thread named_writer([&] {
        opening.join();
        in_pieces([&](const char* text) { named << text << std::flush; });
        named.close();
    });
    EXPECT_EQ(read_file(pipe), "name = 1");
    named_writer.join();
    std::thread writer([&] {
        in_pieces([&](const char* text) { EXPECT_EQ(::write(ends[1], text, 4), 4); });
        ::close(ends[1]);
    });
    EXPECT_EQ(read_file(substituted), "name = 1");
    writer.join();
    ::close(ends[0]);
}

TEST(ReadFile, TakesAnEmptyFileAndADevice) {
    const TestFolder folder;
    write_file(folder.path() / "empty", "");
    EXPECT_EQ(read_file(folder.path() / "empty"), "");
    EXPECT_EQ(read_file("/dev/null"), "");
    EXPECT_TRUE(says(complaint(folder.path()), "is a folder"));
}

// Names of more than 255 bytes are no file's, and to ask for them is no error.
TEST(IsThere, WhatNoFileCanBeCalledIsNot) {
    const TestFolder folder;
    write_file(folder.path() / "file", "");
    EXPECT_TRUE(is_there(folder.path() / "file"));
    EXPECT_TRUE(is_there(folder.path()));
    EXPECT_FALSE(is_folder(folder.path() / "file"));
    EXPECT_TRUE(is_folder(folder.path()));
    const std::filesystem::path long_name = folder.path() / std::string(300, 'x');
    EXPECT_FALSE(is_there(long_name));
    EXPECT_FALSE(is_folder(long_name));
}

}  // namespace lensproof::file_test
