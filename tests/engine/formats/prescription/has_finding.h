// tests/engine/formats/prescription/has_finding.h — what a reader had to say.
#pragma once
#include <algorithm>
#include <string>

#include "engine/optics/prescription.h"

namespace lensproof::formats {

inline bool has_finding(const optics::Prescription& prescription, const std::string& code, const std::string& words) {
    return std::ranges::any_of(prescription.remarks, [&](const optics::Finding& finding) {
        return finding.code == code && finding.message.find(words) != std::string::npos;
    });
}

}  // namespace lensproof::formats
