// engine/scene/chart/aruco.h — ArUco markers, of which ChArUco boards are made.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

namespace lensproof::scene {

/// A set of markers by OpenCV's name for it.
struct ArucoDictionary {
    std::string name;                    // "DICT_4X4_50"
    int cells = 0;                       // of a marker's pattern, along a side
    std::vector<std::uint64_t> markers;  // as `CharucoBoard::markers`
};

/// "DICT_4X4_50", "DICT_4X4_100", "DICT_4X4_250" and those of 5X5 and 6X6.
std::vector<std::string> known_aruco_dictionaries();

/// One of the known dictionaries, from engine/scene/data/aruco.csv. Throws InputError listing them for another name.
ArucoDictionary aruco_dictionary(const std::string& name);

}  // namespace lensproof::scene
