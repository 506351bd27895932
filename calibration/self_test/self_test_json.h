// calibration/self_test/self_test_json.h — traits of pictures and a profile's self-test as JSON.
#pragma once
#include <nlohmann/json.hpp>

#include "calibration/photos/picture_traits.h"
#include "calibration/profile/json_node.h"
#include "calibration/self_test/self_test.h"

namespace lensproof::calibration {

nlohmann::ordered_json to_json(const PictureTraits& traits);
nlohmann::ordered_json to_json(const SelfTest& test);

// What the above wrote. Throw InputError as JsonNode does.
PictureTraits parse_traits(const JsonNode& node);
SelfTest parse_self_test(const JsonNode& node);

}  // namespace lensproof::calibration
