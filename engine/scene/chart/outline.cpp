#include "engine/scene/chart/outline.h"

namespace lensproof::scene {

OutlineShape rectangle(const Vec2d& least, const Vec2d& most, bool is_black) {
    return {OutlinePolygon{{{least.x, least.y}, {most.x, least.y}, {most.x, most.y}, {least.x, most.y}}}, is_black};
}

OutlineShape rectangle(const Vec2d& size_mm) {
    return rectangle({-0.5 * size_mm.x, -0.5 * size_mm.y}, {0.5 * size_mm.x, 0.5 * size_mm.y});
}

OutlineShape rectangle(const Vec2d& centre, const Vec2d& along, double length_mm, double width_mm) {
    const Vec2d a{0.5 * length_mm * along.x, 0.5 * length_mm * along.y};
    const Vec2d b{-0.5 * width_mm * along.y, 0.5 * width_mm * along.x};
    return {OutlinePolygon{{{centre.x - a.x - b.x, centre.y - a.y - b.y},
                            {centre.x + a.x - b.x, centre.y + a.y - b.y},
                            {centre.x + a.x + b.x, centre.y + a.y + b.y},
                            {centre.x - a.x + b.x, centre.y - a.y + b.y}}}};
}

Outline board_squares(GridSize size, double square_mm) {
    Outline outline;
    for (int row = 0; row < size.rows; ++row) {
        for (int column = row % 2; column < size.columns; column += 2) {
            const double x = (column - 0.5 * size.columns) * square_mm;
            const double y = (row - 0.5 * size.rows) * square_mm;
            outline.push_back(rectangle({x, y}, {x + square_mm, y + square_mm}));
        }
    }
    return outline;
}

}  // namespace lensproof::scene
