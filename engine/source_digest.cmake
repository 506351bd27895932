# Writes HEADER, which holds a digest of FILES as the constant NAME: where any of them changes, it does.
foreach(file IN LISTS FILES)
    file(SHA256 "${file}" digest)
    string(APPEND digests "${digest}")
endforeach()
string(SHA256 digest "${digests}")
file(WRITE "${HEADER}" "#pragma once
#include <string_view>

namespace lensproof {
inline constexpr std::string_view ${NAME} = \"${digest}\";
}
")
