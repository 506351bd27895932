#include "engine/render/engine_version.h"

#include "engine/base/hash.h"
#include "engine_digest.h"

namespace lensproof::render {

std::string engine_version() {
    return LENSPROOF_VERSION "+" + hash_text(kEngineDigest);
}

}  // namespace lensproof::render
