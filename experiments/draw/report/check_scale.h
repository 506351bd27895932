// experiments/draw/report/check_scale.h — a check's value against its limit, as a picture in its row.
#pragma once
#include <string>

#include "engine/base/json.h"

namespace lensproof::draw {

/// An <svg> as wide as its cell: where the check holds, its limit, the value with its 95 % interval and the method's
/// own error. The limit stands at the same place in every row of its kind, so that rows can be compared by eye. "" for
/// a check without a limit. Percentages place the parts and pixels shape them, so that it keeps its form at every
/// width.
std::string check_scale_html(const Json& check);

}  // namespace lensproof::draw
