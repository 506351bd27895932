// engine/base/visible.h — names as they may be shown: whoever chose them does not steer the reader's terminal.
#pragma once
#include <string>
#include <string_view>

namespace lensproof {

/// `text` with what a terminal acts upon or does not show written out, as JSON does it (\u001b): control characters but
/// line feeds and tabs, marks of direction, of width 0 and of breaks (U+061C, U+200B to U+200F, U+2028 to U+202E,
/// U+2060 to U+206F, U+FEFF). Bytes that are no UTF-8 become U+FFFD.
std::string visible(std::string_view text);

/// The same with line feeds written out too: what stands in a line of somebody else's words begins none of its own.
std::string visible_in_line(std::string_view text);

}  // namespace lensproof
