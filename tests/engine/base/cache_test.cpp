#include "engine/base/cache.h"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <chrono>
#include <cstdlib>
#include <fstream>
#include <thread>
#include <vector>

#include "engine/base/file.h"
#include "engine/base/write_file.h"
#include "tests/test_folder.h"

namespace lensproof::cache_test {

namespace fs = std::filesystem;

const std::string kKey{"every number\0 of a lens", 23};
const std::string kPayload{"what follows\0 from it", 21};

TEST(Cache, FindsWhatWasStored) {
    const TestFolder folder;
    const Cache cache(folder.path() / "made" / "on demand");
    EXPECT_EQ(cache.find("pupil", kKey), std::nullopt);
    cache.store("pupil", kKey, kPayload);
    EXPECT_EQ(cache.find("pupil", kKey), kPayload);
    cache.store("pupil", kKey, "newer");
    EXPECT_EQ(cache.find("pupil", kKey), "newer");
    cache.store("nothing", "", "");
    EXPECT_EQ(cache.find("nothing", ""), "");
    EXPECT_EQ(cache.find("pupil", kKey + '\0'), std::nullopt);
    EXPECT_EQ(cache.find("pupi", "l" + kKey), std::nullopt);
    EXPECT_EQ(cache.find("region", kKey), std::nullopt);
}

/// Asks for the key while its file holds `content`.
std::optional<std::string> answer_of(const Cache& cache, const std::string& content) {
    std::ofstream(cache.file("pupil", kKey), std::ios::binary) << content;
    return cache.find("pupil", kKey);
}

// Every file that is a byte short, long or different is refused, wherever the byte stands.
TEST(Cache, RefusesEveryDamagedFile) {
    const TestFolder folder;
    const Cache cache(folder.path());
    cache.store("pupil", kKey, kPayload);
    const std::string whole = read_file(cache.file("pupil", kKey));
    ASSERT_EQ(answer_of(cache, whole), kPayload);
    for (std::size_t i = 0; i < whole.size(); ++i) {
        EXPECT_EQ(answer_of(cache, whole.substr(0, i)), std::nullopt) << "cut at " << i;
        EXPECT_EQ(answer_of(cache, whole.substr(i + 1)), std::nullopt) << "begins behind " << i;
        for (int bit = 0; bit < 8; ++bit) {
            std::string flipped = whole;
            flipped[i] = static_cast<char>(flipped[i] ^ (1 << bit));
            EXPECT_EQ(answer_of(cache, flipped), std::nullopt) << "byte " << i << ", bit " << bit;
        }
        std::string blank = whole;
        blank.replace(i, std::string::npos, whole.size() - i, '\0');
        EXPECT_EQ(answer_of(cache, blank), std::nullopt) << "blank from " << i;
        std::string huge = whole;
        huge.replace(i, 8, 8, '\xff');
        EXPECT_EQ(answer_of(cache, huge), std::nullopt) << "a length of 2^64 − 1 at " << i;
    }
    EXPECT_EQ(answer_of(cache, whole + '\0'), std::nullopt);
    EXPECT_EQ(answer_of(cache, whole + whole), std::nullopt);
    EXPECT_EQ(answer_of(cache, whole), kPayload) << "the whole file is taken again";
}

// Another key's file, whole and with a true checksum, under this key's name: what a collision of hashes would leave.
TEST(Cache, RefusesAnotherKeysFile) {
    const TestFolder folder;
    const Cache cache(folder.path());
    for (const auto& [kind, key] : {std::pair{"pupil", std::string("other")}, std::pair{"region", kKey}}) {
        cache.store(kind, key, "wrong");
        fs::rename(cache.file(kind, key), cache.file("pupil", kKey));
        EXPECT_EQ(cache.find("pupil", kKey), std::nullopt);
        cache.store("pupil", kKey, kPayload);
        EXPECT_EQ(cache.find("pupil", kKey), kPayload) << "and it is replaced";
    }
}

// Whatever is in the way, nothing is found, nothing is thrown, and nothing waits.
TEST(Cache, WhatIsInTheWayIsNoError) {
    const TestFolder folder;
    const auto keeps = [](const Cache& cache) {
        cache.store("pupil", kKey, kPayload);
        return cache.find("pupil", kKey).has_value();
    };
    EXPECT_FALSE(keeps(Cache()));
    write_file(folder.path() / "file", "");
    EXPECT_FALSE(keeps(Cache(folder.path() / "file")));
    EXPECT_FALSE(keeps(Cache(folder.path() / "file" / "below")));
    EXPECT_FALSE(keeps(Cache("/proc/nowhere")));
    EXPECT_FALSE(keeps(Cache(folder.path() / std::string(300, 'x'))));

    const Cache a_folder(folder.path() / "a");
    fs::create_directories(a_folder.file("pupil", kKey) / "below");
    EXPECT_FALSE(keeps(a_folder));
    const Cache a_pipe(folder.path() / "b");
    fs::create_directories(folder.path() / "b");
    ASSERT_EQ(::mkfifo(a_pipe.file("pupil", kKey).c_str(), 0600), 0);
    EXPECT_FALSE(keeps(a_pipe));
    const Cache a_loop(folder.path() / "c");
    fs::create_directories(folder.path() / "c");
    fs::create_symlink(a_loop.file("pupil", kKey), a_loop.file("pupil", kKey));
    EXPECT_FALSE(keeps(a_loop));
}

// Three files of about 300 bytes and room for two: those used last stay, and what is not the cache's own is left alone.
TEST(Cache, KeepsWhatWasUsedLast) {
    const TestFolder folder;
    const Cache cache(folder.path(), 700);
    const std::string payload(200, 'p');
    const auto store_aged = [&](const char* key, int hours) {
        cache.store("pupil", key, payload);
        fs::last_write_time(cache.file("pupil", key), fs::file_time_type::clock::now() - std::chrono::hours(hours));
    };
    write_file(folder.path() / "notes.txt", std::string(1000, 'n'));
    fs::last_write_time(folder.path() / "notes.txt", fs::file_time_type::clock::now() - std::chrono::hours(9));
    store_aged("first", 3);
    store_aged("second", 2);
    EXPECT_EQ(cache.find("pupil", "first"), payload) << "now used after the second";
    cache.store("pupil", "third", payload);
    EXPECT_EQ(cache.find("pupil", "first"), payload);
    EXPECT_EQ(cache.find("pupil", "second"), std::nullopt);
    EXPECT_EQ(cache.find("pupil", "third"), payload);
    EXPECT_TRUE(fs::exists(folder.path() / "notes.txt"));
    cache.store("pupil", "large", std::string(701, 'p'));
    EXPECT_EQ(cache.find("pupil", "large"), std::nullopt);
    EXPECT_EQ(cache.find("pupil", "third"), payload) << "what cannot be kept makes no room for itself";
}

// Writers race for one file, in turn with readers: each finds nothing or all of one writer's payload.
TEST(Cache, RacingWritersLeaveWholeFiles) {
    const TestFolder folder;
    const Cache cache(folder.path());
    std::vector<std::thread> threads;
    threads.reserve(4);
    std::vector<int> wrong(4);
    for (int i = 0; i < 4; ++i) {
        threads.emplace_back([&, i] {
            for (int round = 0; round < 100; ++round) {
                cache.store("pupil", kKey, std::string(10000 + i, static_cast<char>('a' + i)));
                const auto found = cache.find("pupil", kKey);
                if (found && *found != std::string(10000 + (found->front() - 'a'), found->front())) {
                    ++wrong[i];
                }
            }
        });
    }
    for (std::thread& thread : threads) {
        thread.join();
    }
    EXPECT_EQ(wrong, std::vector<int>(4));
}

/// Sets environment variables (or, with nullptr, removes them) and puts back what was there.
class Environment {
  public:
    void set(const char* variable, const char* value) {
        const char* before = std::getenv(variable);
        before_.emplace_back(variable, before != nullptr ? std::optional<std::string>(before) : std::nullopt);
        value != nullptr ? ::setenv(variable, value, 1) : ::unsetenv(variable);
    }
    Environment() = default;
    Environment(const Environment&) = delete;
    Environment& operator=(const Environment&) = delete;
    ~Environment() {
        for (auto saved = before_.rbegin(); saved != before_.rend(); ++saved) {
            saved->second ? ::setenv(saved->first, saved->second->c_str(), 1) : ::unsetenv(saved->first);
        }
    }

  private:
    std::vector<std::pair<const char*, std::optional<std::string>>> before_;
};

TEST(Cache, TheUsersFolderFollowsTheEnvironment) {
    const auto folder = [] { return Cache::standard().file("pupil", "").parent_path(); };
    Environment environment;
    EXPECT_EQ(folder(), "") << "tests leave the user's own alone";
    environment.set("XDG_CACHE_HOME", "/caches");
    environment.set("HOME", "/home/user");
    environment.set("LENSPROOF_CACHE", "my cache");
    EXPECT_EQ(folder(), "my cache");
    environment.set("LENSPROOF_CACHE", "");
    EXPECT_EQ(folder(), "");
    environment.set("LENSPROOF_CACHE", nullptr);
    EXPECT_EQ(folder(), "/caches/lensproof");
    environment.set("XDG_CACHE_HOME", "not/absolute");
    EXPECT_EQ(folder(), "/home/user/.cache/lensproof");
    environment.set("XDG_CACHE_HOME", "");
    EXPECT_EQ(folder(), "/home/user/.cache/lensproof");
    environment.set("HOME", nullptr);
    EXPECT_EQ(folder(), "");
}

}  // namespace lensproof::cache_test
