// engine/scene/chart/chart_keys.h — what a kind of chart says of its keys in files, to whoever reads or writes them.
//
// `visit_keys(kind, keys)` of each kind names them in the order in which they are read, and `keys` sets what they are:
//
//   keys.grid(key, columns, rows, GridKey)   whole numbers of columns and rows
//   keys.pitch(key, mm, cells)               a length that comes about as many times as there are cells; and
//   keys.length(key, mm, cells)              one that is not what others are parts of
//   keys.part(key, mm, PartKey)              one that has to be smaller than another
//   keys.whole(key, number, WholeKey)
//   keys.angle(key, deg, most_deg)           to either side; may be absent
//   keys.choice(key, names, printed)         returns which of the names; nothing where none is read
//   keys.refuse(key, why)                    what only the values together show to be wrong
//
// Whatever is `printed` stands in the file of a chart to print where its user says nothing (the lengths that have a
// number of cells: what fills the page).
#pragma once
#include "engine/scene/chart/cells.h"

namespace lensproof::scene {

struct GridKey {
    int least = 1;
    GridSize printed;
};

struct PartKey {
    const char* of = "";  // what it has to be smaller than, in words, and
    double most_mm = 0.0;
    double printed_mm = 0.0;
};

struct WholeKey {
    int least = 0;
    int most = 0;
    int printed = 0;
};

}  // namespace lensproof::scene
