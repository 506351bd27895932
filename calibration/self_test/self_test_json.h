// calibration/self_test/self_test_json.h — traits of pictures and a profile's self-test as JSON.
#pragma once

#include "calibration/photos/picture_traits.h"
#include "calibration/self_test/self_test.h"
#include "engine/base/json_node.h"

namespace lensproof::calibration {

Json to_json(const PictureTraits& traits);
Json to_json(const SelfTest& test);

// What the above wrote. Throw InputError as JsonNode does.
PictureTraits parse_traits(const JsonNode& node);
SelfTest parse_self_test(const JsonNode& node);

}  // namespace lensproof::calibration
