#include "engine/base/confined.h"

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <unistd.h>

#include <csignal>
#include <cstdlib>
#include <fstream>
#include <vector>

#include "engine/base/data_root.h"
#include "engine/base/file.h"
#include "engine/base/input_error.h"
#include "engine/base/memory.h"
#include "tests/complaint.h"
#include "tests/test_folder.h"

namespace lensproof::confined_test {

namespace fs = std::filesystem;

/// Runs `test` in a program of its own that distrusts files from its start on.
template <class Test>
void in_distrust(const Test& test) {
    GTEST_FLAG_SET(death_test_style, "threadsafe");
    EXPECT_EXIT(
        {
            distrust_files();
            test();
            std::_Exit(testing::Test::HasFailure() ? 1 : 0);
        },
        testing::ExitedWithCode(0), "");
}

std::string answer(ConfinedWork work, const fs::path& readable) {
    MessageChannel channel = start_confined(work, readable / "some.file", readable);
    channel.send("request");
    return channel.receive();
}

TEST(Confined, AnswersAndRefuses) {
    in_distrust([] {
        const TestFolder folder;
        EXPECT_EQ(
            answer([](const fs::path& file,
                      MessageChannel& channel) { channel.send(file.filename().string() + " " + channel.receive()); },
                   folder.path()),
            "some.file request");
        const ConfinedWork refuses = [](const fs::path&, MessageChannel&) { throw InputError("not like this"); };
        EXPECT_EQ(complaint_about([&] { answer(refuses, folder.path()); }), "not like this");
    });
}

// A crash, an end without an answer, more than was asked for, and more memory than there may be: each is what is wrong
// with the file.
TEST(Confined, NothingThatItDoesHarmsTheAsker) {
    in_distrust([] {
        const TestFolder folder;
        const auto said = [&](ConfinedWork work) { return complaint_about([&] { answer(work, folder.path()); }); };
        EXPECT_TRUE(
            says(said([](const fs::path&, MessageChannel&) { std::raise(SIGSEGV); }), "some.file: its reader ended"));
        EXPECT_TRUE(says(said([](const fs::path&, MessageChannel&) {}), "some.file: its reader ended"));
        EXPECT_TRUE(says(complaint_about([&] {
                             MessageChannel channel =
                                 start_confined([](const fs::path&, MessageChannel& c) { c.send("too long"); },
                                                folder.path() / "some.file", folder.path());
                             channel.receive(3);
                         }),
                         "taken it over"));
#ifndef __SANITIZE_ADDRESS__
        EXPECT_TRUE(says(said([](const fs::path&, MessageChannel& channel) {
                             const std::vector<char> much(static_cast<std::size_t>(memory_bytes()));
                             channel.send({much.data(), 1});
                         }),
                         "MiB of memory"));
#endif
        EXPECT_EQ(answer(
                      [](const fs::path&, MessageChannel& channel) {
                          ::rlimit limit{};
                          ::getrlimit(RLIMIT_CPU, &limit);
                          channel.send(std::to_string(limit.rlim_max));
                      },
                      folder.path()),
                  "60");
    });
}

// It reads what it was given, and neither reads nor writes nor starts anything else.
TEST(Confined, HasNoFilesButWhatItWasGiven) {
    in_distrust([] {
        if (!distrust_files()) {
            return;  // no Landlock on this system
        }
        const TestFolder folder;
        std::ofstream(folder.path() / "some.file") << "inside";
        const ConfinedWork tries = [](const fs::path& file, MessageChannel& channel) {
            std::string done;
            std::string word;
            std::ifstream(file) >> word;
            done += word;
            if (std::ifstream("/etc/passwd") >> word) {
                done += " read another";
            }
            if (std::ofstream(file.parent_path() / "new").is_open()) {
                done += " wrote one";
            }
            if (::unlink(file.c_str()) == 0) {
                done += " removed one";
            }
            ::execl("/bin/true", "true", nullptr);
            channel.send(done);
        };
        EXPECT_EQ(answer(tries, folder.path()), "inside");
        EXPECT_EQ(read_file(folder.path() / "some.file"), "inside");
    });
}

// By name, by links and by way of folders above: what lies beside a file or below may be referred to, and what ships.
TEST(Distrust, KeepsReferencesWithinTheirFolder) {
    const TestFolder folder;
    fs::create_directory(folder.path() / "in");
    fs::create_directory(folder.path() / "in" / "deep");
    const fs::path from = folder.path() / "in" / "scene.toml";
    std::ofstream(folder.path() / "secret") << "s";
    std::ofstream(folder.path() / "in" / "mine") << "m";
    fs::create_symlink(folder.path() / "secret", folder.path() / "in" / "link");
    fs::create_symlink("../mine", folder.path() / "in" / "deep" / "link");
    EXPECT_EQ(referred_file(from, "../secret"), folder.path() / "in" / "../secret");
    in_distrust([&] {
        for (const char* name : {"mine", "deep/link", "./deep/../mine", "not-there"}) {
            EXPECT_EQ(referred_file(from, name), from.parent_path() / name);
        }
        EXPECT_NO_THROW(check_reference(from, data_root() / "lenses" / "tessar.toml"));
        for (const char* name : {"../secret", "link", "/etc/passwd", "deep/../../secret", "..", "../in-not/file"}) {
            EXPECT_TRUE(says(complaint_about([&] { referred_file(from, name); }), "--untrusted")) << name;
        }
    });
}

}  // namespace lensproof::confined_test
