// engine/base/text_encoding.h — the text of a file whose program did not say how it encodes.
#pragma once
#include <string>
#include <string_view>

namespace lensproof {

/// `bytes` as UTF-8 without a byte order mark, whichever they are:
/// - marked by a byte order mark: UTF-8, UTF-16 little or big endian;
/// - UTF-16 without one, told by the zero bytes of its ASCII letters (design programs' files are mostly ASCII);
/// - UTF-8 where every byte fits that, else Windows-1252, whose five unused bytes become '?'.
///
/// Half surrogates and odd last bytes of UTF-16 become '?'; nothing is an error. What comes out may hold zero bytes
/// only where binary junk came in.
std::string to_utf8(std::string_view bytes);

/// `utf8` as UTF-16 little endian behind a byte order mark, as OpticStudio writes. What is no UTF-8 becomes '?'.
std::string to_utf16(std::string_view utf8);

}  // namespace lensproof
