#include "engine/pupil/pupil_nodes.h"

#include <algorithm>
#include <iterator>

#include "engine/pupil/column_fit.h"
#include "engine/pupil/light_end.h"
#include "engine/pupil/pupil_stations.h"

namespace lensproof::pupil {

namespace {

constexpr int kFirstFractions = 16;
constexpr std::size_t kFirstAzimuths = 4;
constexpr std::size_t kMostAzimuths = 16;
// Over azimuth too there are so many regions to be traced that they may each be this much larger.
constexpr double kExcessOverAzimuth = 4.0;
constexpr std::size_t kMostPositions = 9;
// A step of the radius below the first counts for little; below the second it is not halved any more.
constexpr double kSmallStep = 1.0 / 64.0;
constexpr double kSmallestStep = 1.0 / kFinestFractions;
// Of all lenses that ship kinks take twenty more than at first at most (westrogon-24). A lens that wants all of its
// steps halved is given up here, its regions larger than they need be; nodes are at most 9 · 16 · 129.
constexpr std::size_t kMostFractions = 8 * kFirstFractions + 1;
// Between two nodes the middle alone is looked at, where a smooth region is missed by the most; the rest is for kinks,
// where another rim takes over.
constexpr double kSafety = 1.5;
constexpr double kHeightMargin = 0.0005;  // of a region's height, on both sides together

enum class Axis { radius, azimuth, band };
constexpr std::size_t kAxes = 3;

/// Something traced between two nodes, at the fraction t from `a` to `b`: they have to hold it.
struct Between {
    const PupilOutline* outline;
    std::size_t a;
    std::size_t b;
    double t;
    Axis axis;  // along which a and b are neighbours
    std::size_t position;
    std::size_t fraction;  // of a, among the nodes
};
struct Mean {
    double sum = 0.0;
    double weight = 0.0;

    void add(double value_here, double weight_here) {
        sum += weight_here * value_here;
        weight += weight_here;
    }
    [[nodiscard]] double value() const { return weight > 0.0 ? sum / weight : 0.0; }
};

PupilSymmetry symmetry_of(const NodeSearch& search) {
    return search.by_radius ? PupilSymmetry::mirror : PupilSymmetry::none;
}

void add_margin(PupilRegion& region, PupilSymmetry symmetry) {
    double height = 0.0;
    for (const PupilColumn& column : region.columns) {
        height = std::max(height, column.upper - column.lower);
    }
    grow(region, ColumnGrowth(0.5 * kHeightMargin * height), 1.0, symmetry);
}

class NodeFinder {
  public:
    NodeFinder(const std::vector<optics::TraceLens<double>>& band, const RayFamily& rays, const NodeSearch& search)
        : search_(search),
          most_excess_((search.by_radius ? 1.0 : kExcessOverAzimuth) * search.most_excess),
          last_lens_(band.size() - 1),
          stations_(band, rays, search.disc, symmetry_of(search), search.device) {
        nodes_.symmetry = symmetry_of(search);
        nodes_.azimuths = search.by_radius ? 1 : kFirstAzimuths;
    }

    PupilNodes find() {
        set_lenses({0, last_lens_ / 2, last_lens_});
        for (int i = 0; i <= kFirstFractions; ++i) {
            nodes_.fractions.push_back(static_cast<double>(i) / kFirstFractions);
        }
        if (std::ranges::any_of(nodes_.ends, [](double end) { return !(end > 0.0); })) {
            return {};
        }
        do {
            trace();
            measure_excess();
        } while (split_radii() || split_azimuths() || split_band());
        fit();
        return nodes_;
    }

  private:
    // --- Where the light ends ---

    /// Lets these lenses stand at the nodes of the band, and looks where their light ends.
    void set_lenses(std::vector<std::size_t> lenses) {
        lenses.erase(std::unique(lenses.begin(), lenses.end()), lenses.end());
        lenses_ = std::move(lenses);
        // Some wavelengths may end just inside the sensor, others just outside.
        constexpr double kBeyond = 1.1;
        const double farthest = kBeyond * search_.end;
        std::vector<double> azimuths;
        for (std::size_t k = 0; k < nodes_.azimuths; ++k) {
            azimuths.push_back(azimuth(k));
        }
        nodes_.ends =
            light_ends(stations_, lenses_, {.farthest = farthest, .precision = kSmallestStep, .azimuths = azimuths});
        if (std::ranges::all_of(nodes_.ends, [&](double end) { return end == farthest; })) {
            std::ranges::fill(nodes_.ends, search_.end);
        }
        nodes_.positions.clear();
        for (const std::size_t lens : lenses_) {
            nodes_.positions.push_back(position(lens));
        }
    }

    [[nodiscard]] double position(std::size_t lens) const {
        return last_lens_ > 0 ? static_cast<double>(lens) / static_cast<double>(last_lens_) : 0.0;
    }

    static bool is_lit(const PupilOutline* outline) { return outline != nullptr && !outline->is_empty(); }

    // --- Nodes and middles ---

    [[nodiscard]] double azimuth(std::size_t k) const {
        return static_cast<double>(k % nodes_.azimuths) / static_cast<double>(nodes_.azimuths);
    }
    [[nodiscard]] StationPlace node(std::size_t p, std::size_t k, std::size_t i) const {
        return {lenses_[p], azimuth(k), nodes_.fractions[i] * nodes_.ends[p * nodes_.azimuths + k % nodes_.azimuths]};
    }

    /// Calls see(place, between, neighbours) for each middle between two nodes; `between` without its outline.
    template <class See>
    void for_each_middle(const See& see) const {
        for (std::size_t p = 0; p < lenses_.size(); ++p) {
            for (std::size_t k = 0; k < nodes_.azimuths; ++k) {
                for (std::size_t i = 0; i < nodes_.fractions.size(); ++i) {
                    see_middles(p, k, i, see);
                }
            }
        }
    }

    template <class See>
    void see_middles(std::size_t p, std::size_t k, std::size_t i, const See& see) const {
        const StationPlace here = node(p, k, i);
        const std::size_t index = nodes_.index(p, k, i);
        if (i + 1 < nodes_.fractions.size()) {
            const StationPlace next = node(p, k, i + 1);
            see(StationPlace{here.lens, here.azimuth, 0.5 * (here.radius + next.radius)},
                Between{nullptr, index, nodes_.index(p, k, i + 1), 0.5, Axis::radius, p, i}, here, next);
        }
        if (nodes_.azimuths > 1) {
            const StationPlace next = node(p, k + 1, i);
            see(StationPlace{here.lens, here.azimuth + 0.5 / static_cast<double>(nodes_.azimuths),
                             0.5 * (here.radius + next.radius)},
                Between{nullptr, index, nodes_.index(p, (k + 1) % nodes_.azimuths, i), 0.5, Axis::azimuth, p, i}, here,
                next);
        }
        if (p + 1 < lenses_.size() && lenses_[p + 1] > lenses_[p] + 1) {
            const StationPlace next = node(p + 1, k, i);
            const std::size_t lens = (here.lens + next.lens) / 2;
            const double t = static_cast<double>(lens - here.lens) / static_cast<double>(next.lens - here.lens);
            see(StationPlace{lens, here.azimuth, (1.0 - t) * here.radius + t * next.radius},
                Between{nullptr, index, nodes_.index(p + 1, k, i), t, Axis::band, p, i}, here, next);
        }
    }

    /// Traces the nodes, and the middles between them.
    void trace() {
        std::vector<PupilStations::Request> requests;
        for (std::size_t p = 0; p < lenses_.size(); ++p) {
            for (std::size_t k = 0; k < nodes_.azimuths; ++k) {
                for (std::size_t i = 0; i < nodes_.fractions.size(); ++i) {
                    requests.push_back({.place = node(p, k, i)});
                }
            }
        }
        stations_.trace(std::move(requests));
        requests.clear();
        for_each_middle([&](const StationPlace& place, const Between&, const StationPlace& a, const StationPlace& b) {
            requests.push_back({.place = place, .alike = {a, b}});
        });
        stations_.trace(std::move(requests));
    }

    /// Halves the steps of the radius whose regions have to be enlarged too much; whether there are any.
    bool split_radii() {
        std::vector<double> finer;
        for (std::size_t i = 0; i < nodes_.fractions.size(); ++i) {
            finer.push_back(nodes_.fractions[i]);
            if (i + 1 < nodes_.fractions.size()) {
                const double step = nodes_.fractions[i + 1] - nodes_.fractions[i];
                if (radius_excess_[i] > most_excess_ * std::max(1.0, kSmallStep / step) && step > kSmallestStep) {
                    finer.push_back(0.5 * (nodes_.fractions[i] + nodes_.fractions[i + 1]));
                }
            }
        }
        if (finer.size() == nodes_.fractions.size() || finer.size() > kMostFractions) {
            return false;
        }
        nodes_.fractions = std::move(finer);
        return true;
    }

    bool split_azimuths() {
        if (!(azimuth_excess_ > most_excess_) || nodes_.azimuths >= kMostAzimuths) {
            return false;
        }
        nodes_.azimuths *= 2;
        set_lenses(lenses_);
        return true;
    }

    bool split_band() {
        std::vector<std::size_t> finer;
        for (std::size_t p = 0; p < lenses_.size(); ++p) {
            finer.push_back(lenses_[p]);
            if (p + 1 < lenses_.size() && band_excess_[p] > most_excess_ && lenses_[p + 1] > lenses_[p] + 1) {
                finer.push_back((lenses_[p] + lenses_[p + 1]) / 2);
            }
        }
        if (finer.size() == lenses_.size() || finer.size() > kMostPositions) {
            return false;
        }
        set_lenses(std::move(finer));
        return true;
    }

    // --- Regions ---

    /// The outline at a node; where it is dark, that of the next lit one inwards, outwards, or on another azimuth: at
    /// the light's end one is lit.
    [[nodiscard]] const PupilOutline& outline_at(std::size_t p, std::size_t k, std::size_t i) const {
        const std::size_t count = nodes_.fractions.size();
        for (std::size_t turn = 0; turn + 1 < nodes_.azimuths * count; ++turn) {
            const std::size_t step = turn % count;
            const PupilOutline* outline = stations_.find(node(p, k + turn / count, step <= i ? i - step : step));
            if (is_lit(outline)) {
                return *outline;
            }
        }
        return *stations_.find(node(p, k + nodes_.azimuths - 1, count - 1));
    }

    /// Regions that hold the outlines at the nodes and at the middles between them, along each axis; what is missed
    /// away from the axes adds up from them.
    void fit() {
        const std::vector<Between> middles = lit_middles();
        const std::vector<const PupilOutline*> outlines = node_outlines();
        set_own_regions(outlines, middles);
        std::array<std::vector<ColumnGrowth>, kAxes> growth;
        growth.fill(std::vector<ColumnGrowth>(nodes_.regions.size()));
        for (const Between& middle : middles) {
            const PupilRegion between = mean_region(nodes_.regions[middle.a], nodes_.regions[middle.b], middle.t);
            const ColumnGrowth missing = missing_growth(between, {middle.outline, 1}, nodes_.symmetry);
            growth[static_cast<std::size_t>(middle.axis)][middle.a].include(missing);
            growth[static_cast<std::size_t>(middle.axis)][middle.b].include(missing);
        }
        for (const std::vector<ColumnGrowth>& along : growth) {
            for (std::size_t i = 0; i < along.size(); ++i) {
                grow(nodes_.regions[i], along[i], kSafety, nodes_.symmetry);
            }
        }
        for (PupilRegion& region : nodes_.regions) {
            add_margin(region, nodes_.symmetry);
        }
    }

    [[nodiscard]] std::vector<Between> lit_middles() const {
        std::vector<Between> middles;
        for_each_middle([&](const StationPlace& place, Between middle, const StationPlace&, const StationPlace&) {
            middle.outline = stations_.find(place);
            if (is_lit(middle.outline)) {
                middles.push_back(middle);
            }
        });
        return middles;
    }

    [[nodiscard]] std::vector<const PupilOutline*> node_outlines() const {
        std::vector<const PupilOutline*> outlines;
        for (std::size_t p = 0; p < lenses_.size(); ++p) {
            for (std::size_t k = 0; k < nodes_.azimuths; ++k) {
                for (std::size_t i = 0; i < nodes_.fractions.size(); ++i) {
                    outlines.push_back(&outline_at(p, k, i));
                }
            }
        }
        return outlines;
    }

    /// What the extents of two nodes lack to hold that of an outline between them.
    [[nodiscard]] Extent missing_extent(const Extent& a, const Extent& b, const Between& middle) const {
        const Extent needed = own_extent(*middle.outline);
        return {std::min(0.0, needed.left - (1.0 - middle.t) * a.left - middle.t * b.left),
                std::max(0.0, needed.right - (1.0 - middle.t) * a.right - middle.t * b.right)};
    }

    /// Regions around the nodes' own outlines, as wide as the middles need.
    void set_own_regions(const std::vector<const PupilOutline*>& outlines, const std::vector<Between>& middles) {
        std::vector<Extent> extents;
        std::ranges::transform(outlines, std::back_inserter(extents),
                               [&](const PupilOutline* outline) { return own_extent(*outline); });
        std::array<std::vector<Extent>, kAxes> more;  // to be added
        more.fill(std::vector<Extent>(extents.size(), {0.0, 0.0}));
        for (const Between& middle : middles) {
            const Extent missing = missing_extent(extents[middle.a], extents[middle.b], middle);
            for (const std::size_t node : {middle.a, middle.b}) {
                Extent& here = more[static_cast<std::size_t>(middle.axis)][node];
                here = {std::min(here.left, missing.left), std::max(here.right, missing.right)};
            }
        }
        nodes_.regions.clear();
        for (std::size_t i = 0; i < outlines.size(); ++i) {
            Extent extent = extents[i];
            for (const std::vector<Extent>& along : more) {
                extent = {extent.left + kSafety * along[i].left, extent.right + kSafety * along[i].right};
            }
            nodes_.regions.push_back(region_around({outlines[i], 1}, extent, nodes_.symmetry));
        }
    }

    [[nodiscard]] Extent own_extent(const PupilOutline& outline) const {
        const Extent extent = extent_of({&outline, 1});
        return {search_.by_radius ? 0.0 : extent.left, extent.right};
    }

    /// By how much the region between two nodes, enlarged to hold what was traced there, is larger than that.
    [[nodiscard]] double excess_of(const PupilOutline& at_a, const PupilOutline& at_b, const Between& middle) const {
        const auto around = [&](const PupilOutline& outline, const Extent& more) {
            const Extent own = own_extent(outline);
            return region_around({&outline, 1}, {own.left + kSafety * more.left, own.right + kSafety * more.right},
                                 nodes_.symmetry);
        };
        const Extent missing = missing_extent(own_extent(at_a), own_extent(at_b), middle);
        PupilRegion between = mean_region(around(at_a, missing), around(at_b, missing), middle.t);
        grow(between, missing_growth(between, {middle.outline, 1}, nodes_.symmetry), kSafety, nodes_.symmetry);
        const PupilRegion own = around(*middle.outline, {0.0, 0.0});
        return between.width * between.columns.back().area_before / (own.width * own.columns.back().area_before) - 1.0;
    }

    /// The mean excess at each step of the radius, and over the sensor's area for the other axes.
    void measure_excess() {
        const std::vector<const PupilOutline*> outlines = node_outlines();
        std::vector<Mean> by_step(nodes_.fractions.size());
        std::vector<Mean> by_position(lenses_.size());
        Mean by_azimuth;
        for (const Between& middle : lit_middles()) {
            const auto [known, is_new] = excesses_.try_emplace({middle.outline, middle.axis}, 0.0);
            if (is_new) {
                known->second = excess_of(*outlines[middle.a], *outlines[middle.b], middle);
            }
            const double fraction = nodes_.fractions[middle.fraction];
            const double step = fraction - nodes_.fractions[middle.fraction > 0 ? middle.fraction - 1 : 0];
            if (middle.axis == Axis::radius) {
                by_step[middle.fraction].add(known->second, 1.0);
            } else {
                (middle.axis == Axis::band ? by_position[middle.position] : by_azimuth)
                    .add(known->second, fraction * step);
            }
        }
        radius_excess_.clear();
        std::ranges::transform(by_step, std::back_inserter(radius_excess_), &Mean::value);
        band_excess_.clear();
        std::ranges::transform(by_position, std::back_inserter(band_excess_), &Mean::value);
        azimuth_excess_ = by_azimuth.value();
    }

    const NodeSearch& search_;
    double most_excess_;
    std::size_t last_lens_;
    PupilStations stations_;
    std::vector<std::size_t> lenses_;  // at the nodes of the band
    PupilNodes nodes_;
    std::map<std::pair<const PupilOutline*, Axis>, double> excesses_;  // of middles
    std::vector<double> radius_excess_;                                // of each step of the radius
    std::vector<double> band_excess_;                                  // of each step in the band
    double azimuth_excess_ = 0.0;
};

}  // namespace

void open_stop(optics::TraceLens<double>& lens) {
    for (optics::SpecialSurface<double>& special : lens.specials) {
        special.mask = {};
    }
}

PupilNodes find_pupil_nodes(std::vector<optics::TraceLens<double>> band, const RayFamily& rays,
                            const NodeSearch& search) {
    for (optics::TraceLens<double>& lens : band) {
        open_stop(lens);
    }
    return NodeFinder(band, rays, search).find();
}

}  // namespace lensproof::pupil
