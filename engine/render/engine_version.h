// engine/render/engine_version.h — which engine this is.
#pragma once
#include <string>

namespace lensproof::render {

/// The project's version and a digest of the engine's sources, "0.1.0+4f1d2c3b5a697887": what a picture was made by;
/// "0.1.0-fused+…" where the build fuses products (LENSPROOF_FUSED).
/// Checkpoints and shards of one render are of one version.
std::string engine_version();

}  // namespace lensproof::render
