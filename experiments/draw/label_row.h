// experiments/draw/label_row.h — labels side by side, each as near to what it names as the others let it.
#pragma once
#include <vector>

namespace lensproof::draw {

/// A label that would like its middle at `x`.
struct PlacedLabel {
    double x = 0.0;
    double width = 0.0;
};

/// Where the labels' middles come to lie between `left` and `right`, in the order of the x that they wish, none
/// covering another: each group of labels that are in one another's way is centred on what it wishes (the
/// pool-adjacent-violators algorithm). Labels that are wider in all than the row overlap evenly.
std::vector<double> spread_labels(const std::vector<PlacedLabel>& labels, double left, double right);

}  // namespace lensproof::draw
