// tests/engine/base/data_root_test.cpp — where a program finds what ships with it.
#include "engine/base/data_root.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <optional>
#include <string>

#include "tests/test_folder.h"

namespace lensproof::data_root_test {

/// $LENSPROOF_HOME while it lives; then what it was.
class Home {
  public:
    explicit Home(const char* value) {
        const char* before = std::getenv(kName);
        before_ = before != nullptr ? std::optional<std::string>(before) : std::nullopt;
        value != nullptr ? ::setenv(kName, value, 1) : ::unsetenv(kName);
    }
    ~Home() { before_ ? ::setenv(kName, before_->c_str(), 1) : ::unsetenv(kName); }
    Home(const Home&) = delete;
    Home& operator=(const Home&) = delete;

  private:
    static constexpr const char* kName = "LENSPROOF_HOME";
    std::optional<std::string> before_;
};

// The build folder stands for an installation: its share/lensproof is a link to the sources.
TEST(DataRoot, LiesAboveTheProgram) {
    const Home none(nullptr);
    EXPECT_TRUE(exists(data_root() / "lenses" / "tessar.toml"));
    EXPECT_EQ(data_root(), canonical(data_root())) << "messages name files by it";
    const Home empty("");
    EXPECT_TRUE(exists(data_root() / "lenses" / "tessar.toml"));
}

TEST(DataRoot, IsWhatTheUserSays) {
    const TestFolder folder;
    const Home home(folder.path().c_str());
    EXPECT_EQ(data_root(), folder.path());
}

}  // namespace lensproof::data_root_test
