// Linked into every test program: what users keep is neither read nor filled, by it or by programs that it starts.
#include <gtest/gtest.h>

#include <cstdlib>

namespace lensproof {
namespace {

class WithoutUserCache : public testing::Environment {
  public:
    void SetUp() override { ::setenv("LENSPROOF_CACHE", "off", 1); }
};

[[maybe_unused]] const testing::Environment* const kWithoutUserCache =
    testing::AddGlobalTestEnvironment(new WithoutUserCache);

}  // namespace
}  // namespace lensproof
