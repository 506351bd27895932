#include "engine/pupil/pupil_nodes.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "engine/optics/rim_margin.h"
#include "engine/pupil/column_fit.h"
#include "engine/pupil/pupil_outline.h"

namespace lensproof {

namespace {

constexpr int kFirstRadii = 16;
constexpr std::size_t kFirstAzimuths = 4;
constexpr std::size_t kMostAzimuths = 32;
// Of the sensor's radius: below the first, a step counts for little; below the second it is not halved any more.
constexpr double kSmallStep = 1.0 / 64.0;
constexpr double kSmallestStep = 1.0 / 8192.0;

/// A place on the sensor; azimuths as shares of a turn. Ordered along the radii.
struct SensorPlace {
    double azimuth = 0.0;
    double radius = 0.0;
    friend auto operator<=>(const SensorPlace&, const SensorPlace&) = default;
};

/// The outlines there, one for each wavelength.
struct Station {
    std::vector<PupilOutline> outlines;

    [[nodiscard]] bool is_dark() const { return std::ranges::all_of(outlines, &PupilOutline::is_empty); }
};

class NodeFinder {
  public:
    NodeFinder(const std::vector<TraceLens<double>>& band, const RearDisc& disc, const NodeSearch& search)
        : band_(band),
          disc_(disc),
          search_(search),
          symmetry_(search.by_radius ? PupilSymmetry::mirror : PupilSymmetry::none),
          azimuths_(search.by_radius ? 1 : kFirstAzimuths) {}

    PupilNodes find() {
        for (int i = 0; i <= kFirstRadii; ++i) {
            radii_.push_back(search_.sensor_radius_mm * i / kFirstRadii);
        }
        trace_nodes();
        drop_dark_nodes();
        do {
            trace_radius_middles();
            narrow_edge();
            fit();
        } while (split_radii());
        while (!search_.by_radius && azimuths_ < kMostAzimuths) {
            trace_azimuth_middles();
            fit();
            if (!(azimuth_excess_ > search_.most_excess)) {
                break;
            }
            azimuths_ *= 2;
            trace_nodes();
            trace_radius_middles();
        }
        return finished();
    }

  private:
    // --- Tracing ---

    void trace_nodes() {
        std::vector<SensorPlace> places;
        for (std::size_t k = 0; k < azimuths_; ++k) {
            for (const double radius : radii_) {
                places.push_back({azimuth(k), radius});
            }
        }
        trace_at(places);
    }

    void trace_radius_middles() {
        std::vector<SensorPlace> places;
        for (std::size_t k = 0; k < azimuths_; ++k) {
            for (std::size_t i = 0; i + 1 < radii_.size(); ++i) {
                places.push_back({azimuth(k), 0.5 * (radii_[i] + radii_[i + 1])});
            }
            if (has_edge()) {
                places.push_back({azimuth(k), 0.5 * (radii_.back() + first_dark_)});
            }
        }
        trace_at(places);
    }

    void trace_azimuth_middles() {
        std::vector<SensorPlace> places;
        for (std::size_t k = 0; k < azimuths_; ++k) {
            for (const double radius : radii_) {
                places.push_back({azimuth(k) + 0.5 / static_cast<double>(azimuths_), radius});
            }
        }
        trace_at(places);
    }

    /// Traces the outlines at the places that have none yet, all together.
    void trace_at(std::vector<SensorPlace> places) {
        std::erase_if(places, [&](const SensorPlace& place) { return stations_.contains(place); });
        std::vector<std::optional<PupilFrame>> expected;
        for (std::size_t lens = 0; lens < band_.size(); ++lens) {
            for (const SensorPlace& place : places) {
                expected.push_back(expected_frame(place, lens));
            }
        }
        const PassTest passes = [&](std::span<const RegionPoint> points, std::span<std::uint8_t> answers) {
            for (std::size_t i = 0; i < points.size(); ++i) {
                const auto region = static_cast<std::size_t>(points[i].region);
                const Ray<double> ray = ray_from(places[region % places.size()], points[i].point);
                const TraceLens<double>& lens = band_[region / places.size()];
                answers[i] = trace<Direction::reverse>(lens, ray).status == RayStatus::ok ? 1 : 0;
            }
        };
        const OutlineSearch search{.radius = disc_.radius, .symmetry = symmetry_, .look_closer = [&](int region) {
                                       const auto index = static_cast<std::size_t>(region);
                                       return point_by_margin(band_[index / places.size()],
                                                              places[index % places.size()]);
                                   }};
        std::vector<PupilOutline> outlines = pupil_outlines(passes, expected, search);
        for (std::size_t i = 0; i < outlines.size(); ++i) {
            stations_[places[i % places.size()]].outlines.push_back(std::move(outlines[i]));
        }
    }

    /// From the sensor through a point of the pupil that is given in the place's frame.
    [[nodiscard]] Ray<double> ray_from(const SensorPlace& place, Vec2d pupil_point) const {
        const double angle = 2.0 * std::numbers::pi * place.azimuth;
        const double cosine = std::cos(angle);
        const double sine = std::sin(angle);
        const Vec3d from{place.radius * sine, place.radius * cosine, band_.front().image_z};
        const Vec3d to{cosine * pupil_point.x + sine * pupil_point.y, cosine * pupil_point.y - sine * pupil_point.x,
                       disc_.plane_z};
        return {from, normalized(to - from)};
    }

    /// A point of a region that is thinner than a grid, by how far rays stand from the rims.
    [[nodiscard]] std::optional<Vec2d> point_by_margin(const TraceLens<double>& lens, const SensorPlace& place) const {
        return find_inside([&](Vec2d at) { return rim_margin(lens, ray_from(place, at), Direction::reverse); },
                           {.start = {}, .reach = disc_.radius, .is_mirror = search_.by_radius});
    }

    /// The mean of the neighbours' frames along the radius, or else along the azimuth; nothing where there are none.
    [[nodiscard]] std::optional<PupilFrame> expected_frame(const SensorPlace& place, std::size_t lens) const {
        const double half_step = 0.5 / static_cast<double>(azimuths_);
        const auto wrapped = [](double azimuth) { return azimuth - std::floor(azimuth); };
        std::vector<std::map<SensorPlace, Station>::const_iterator> near;
        const auto above = stations_.upper_bound(place);
        if (above != stations_.end() && above->first.azimuth == place.azimuth) {
            near.push_back(above);
        }
        if (above != stations_.begin() && std::prev(above)->first.azimuth == place.azimuth) {
            near.push_back(std::prev(above));
        }
        if (near.empty()) {
            near = {stations_.find({wrapped(place.azimuth - half_step), place.radius}),
                    stations_.find({wrapped(place.azimuth + half_step), place.radius})};
        }
        std::erase_if(near, [&](const auto& it) {
            return it == stations_.end() || it->second.outlines.size() <= lens || it->second.outlines[lens].is_empty();
        });
        if (near.empty()) {
            return std::nullopt;
        }
        const double share = 1.0 / static_cast<double>(near.size());
        PupilFrame mean{.centre = {}, .scale = {}, .bend = 0.0};
        for (const auto& it : near) {
            const PupilFrame& frame = it->second.outlines[lens].frame;
            mean.centre = {mean.centre.x + share * frame.centre.x, mean.centre.y + share * frame.centre.y};
            mean.scale = {mean.scale.x + share * frame.scale.x, mean.scale.y + share * frame.scale.y};
            mean.bend += share * frame.bend;
        }
        return mean;
    }

    // --- Nodes ---

    [[nodiscard]] double azimuth(std::size_t k) const {
        return static_cast<double>(k % azimuths_) / static_cast<double>(azimuths_);
    }
    [[nodiscard]] const Station& station(double azimuth_share, double radius) const {
        return stations_.at({azimuth_share, radius});
    }
    [[nodiscard]] bool is_dark_everywhere(double radius) const {
        for (std::size_t k = 0; k < azimuths_; ++k) {
            if (!station(azimuth(k), radius).is_dark()) {
                return false;
            }
        }
        return true;
    }
    [[nodiscard]] bool has_edge() const { return first_dark_ > 0.0; }
    [[nodiscard]] double step(std::size_t i) const { return radii_[i + 1] - radii_[i]; }

    void drop_dark_nodes() {
        while (!radii_.empty() && is_dark_everywhere(radii_.back())) {
            first_dark_ = radii_.back();
            radii_.pop_back();
        }
    }

    /// Halves the step in which the light ends.
    void narrow_edge() {
        if (!has_edge() || radii_.empty()) {
            return;
        }
        const double middle = 0.5 * (radii_.back() + first_dark_);
        if (is_dark_everywhere(middle)) {
            first_dark_ = middle;
        } else {
            radii_.push_back(middle);
            trace_radius_middles();
        }
    }

    /// Halves the steps whose regions have to be enlarged too much; whether there are any, or the edge is still wide.
    bool split_radii() {
        std::vector<double> finer;
        const double smallest = kSmallestStep * search_.sensor_radius_mm;
        for (std::size_t i = 0; i < radii_.size(); ++i) {
            finer.push_back(radii_[i]);
            if (i + 1 < radii_.size()) {
                const double allowed =
                    search_.most_excess * std::max(1.0, kSmallStep * search_.sensor_radius_mm / step(i));
                if (radius_excess_[i] > allowed && step(i) > smallest) {
                    finer.push_back(0.5 * (radii_[i] + radii_[i + 1]));
                }
            }
        }
        const bool is_split = finer.size() > radii_.size();
        radii_ = std::move(finer);
        return is_split || (has_edge() && !radii_.empty() && first_dark_ - radii_.back() > smallest);
    }

    // --- Regions ---

    [[nodiscard]] std::size_t index(std::size_t i, std::size_t k) const { return i * azimuths_ + k % azimuths_; }

    /// The outlines at a node; where it is dark, those of the next lit one on its azimuth, or of any.
    [[nodiscard]] const std::vector<PupilOutline>& outlines_at_node(std::size_t i, std::size_t k) const {
        for (std::size_t turn = 0; turn < azimuths_; ++turn) {
            for (std::size_t back = 0; back <= i; ++back) {
                const Station& here = station(azimuth(k + turn), radii_[i - back]);
                if (!here.is_dark()) {
                    return here.outlines;
                }
            }
        }
        return station(azimuth(k), radii_.back()).outlines;
    }

    /// Something traced between nodes: the nodes that it lies in the middle of have to hold it.
    struct Middle {
        const std::vector<PupilOutline>* outlines;
        std::size_t a;
        std::size_t b;
        std::size_t step;  // of which radius step
        bool is_in_radius;
    };

    [[nodiscard]] std::vector<Middle> middles() const {
        std::vector<Middle> all;
        const auto add = [&](double at_azimuth, double radius, const Middle& middle) {
            const auto found = stations_.find({at_azimuth, radius});
            if (found != stations_.end() && !found->second.is_dark()) {
                all.push_back(middle);
                all.back().outlines = &found->second.outlines;
            }
        };
        for (std::size_t k = 0; k < azimuths_; ++k) {
            for (std::size_t i = 0; i < radii_.size(); ++i) {
                if (i + 1 < radii_.size()) {
                    add(azimuth(k), 0.5 * (radii_[i] + radii_[i + 1]),
                        {nullptr, index(i, k), index(i + 1, k), i, true});
                }
                add(azimuth(k) + 0.5 / static_cast<double>(azimuths_), radii_[i],
                    {nullptr, index(i, k), index(i, k + 1), i, false});
            }
        }
        return all;
    }

    /// Regions that hold the outlines at the nodes and at the middles between them, along the radius and along the
    /// azimuth; what is missed in between adds up from both.
    void fit() {
        const std::vector<Middle> between = middles();
        const std::vector<Extent> extents = fitted_extents(between);
        regions_.clear();
        for (std::size_t i = 0; i < radii_.size(); ++i) {
            for (std::size_t k = 0; k < azimuths_; ++k) {
                regions_.push_back(region_around(outlines_at_node(i, k), extents[index(i, k)], symmetry_));
            }
        }
        std::vector<ColumnGrowth> along_radius(regions_.size());
        std::vector<ColumnGrowth> along_azimuth(regions_.size());
        for (const Middle& middle : between) {
            const ColumnGrowth missing = missing_growth(mean_region(middle), *middle.outlines, symmetry_);
            for (const std::size_t node : {middle.a, middle.b}) {
                (middle.is_in_radius ? along_radius : along_azimuth)[node].include(missing);
            }
        }
        for (std::size_t i = 0; i < regions_.size(); ++i) {
            grow(regions_[i], along_radius[i], symmetry_);
            grow(regions_[i], along_azimuth[i], symmetry_);
        }
        measure_excess(between);
    }

    [[nodiscard]] std::vector<Extent> fitted_extents(const std::vector<Middle>& between) const {
        std::vector<Extent> extents;
        for (std::size_t i = 0; i < radii_.size(); ++i) {
            for (std::size_t k = 0; k < azimuths_; ++k) {
                extents.push_back(own_extent(outlines_at_node(i, k)));
            }
        }
        std::vector<Extent> along_radius(extents.size(), {0.0, 0.0});  // to be added
        std::vector<Extent> along_azimuth = along_radius;
        for (const Middle& middle : between) {
            const Extent needed = own_extent(*middle.outlines);
            const Extent& a = extents[middle.a];
            const Extent& b = extents[middle.b];
            for (const std::size_t node : {middle.a, middle.b}) {
                Extent& more = (middle.is_in_radius ? along_radius : along_azimuth)[node];
                more = {std::min(more.left, needed.left - 0.5 * (a.left + b.left)),
                        std::max(more.right, needed.right - 0.5 * (a.right + b.right))};
            }
        }
        for (std::size_t i = 0; i < extents.size(); ++i) {
            extents[i] = {extents[i].left + along_radius[i].left + along_azimuth[i].left,
                          extents[i].right + along_radius[i].right + along_azimuth[i].right};
        }
        return extents;
    }

    [[nodiscard]] Extent own_extent(std::span<const PupilOutline> outlines) const {
        const Extent extent = extent_of(outlines);
        return {search_.by_radius ? 0.0 : extent.left, extent.right};
    }

    [[nodiscard]] PupilRegion mean_region(const Middle& middle) const {
        const PupilRegion& a = regions_[middle.a];
        const PupilRegion& b = regions_[middle.b];
        PupilRegion mean{.left = 0.5 * (a.left + b.left), .width = 0.5 * (a.width + b.width)};
        for (std::size_t i = 0; i < mean.columns.size(); ++i) {
            mean.columns[i] = {.lower = 0.5 * (a.columns[i].lower + b.columns[i].lower),
                               .upper = 0.5 * (a.columns[i].upper + b.columns[i].upper)};
        }
        mean.sum_areas(symmetry_);
        return mean;
    }

    /// By how much the regions between nodes are larger than those that are fitted to what was traced there.
    void measure_excess(const std::vector<Middle>& between) {
        radius_excess_.assign(radii_.size(), 0.0);
        azimuth_excess_ = 0.0;
        for (const Middle& middle : between) {
            const PupilRegion mean = mean_region(middle);
            const PupilRegion own = region_around(*middle.outlines, own_extent(*middle.outlines), symmetry_);
            const double own_area = own.width * own.columns.back().area_before;
            const double excess = mean.width * mean.columns.back().area_before / own_area - 1.0;
            double& largest = middle.is_in_radius ? radius_excess_[middle.step] : azimuth_excess_;
            largest = std::max(largest, excess);
        }
    }

    [[nodiscard]] PupilNodes finished() const {
        PupilNodes nodes{.symmetry = symmetry_, .azimuths = azimuths_, .radii = radii_, .regions = regions_};
        if (has_edge() && !radii_.empty()) {
            // The region shrinks to nothing in the last step, which keeps the larger end's.
            nodes.radii.push_back(first_dark_);
            nodes.regions.insert(nodes.regions.end(), regions_.end() - static_cast<std::ptrdiff_t>(azimuths_),
                                 regions_.end());
        }
        return nodes;
    }

    const std::vector<TraceLens<double>>& band_;
    const RearDisc& disc_;
    const NodeSearch& search_;
    PupilSymmetry symmetry_;
    std::size_t azimuths_;
    std::map<SensorPlace, Station> stations_;
    std::vector<double> radii_;
    double first_dark_ = 0.0;  // 0: light reaches the whole sensor
    std::vector<PupilRegion> regions_;
    std::vector<double> radius_excess_;
    double azimuth_excess_ = 0.0;
};

}  // namespace

PupilNodes find_pupil_nodes(const std::vector<TraceLens<double>>& band, const RearDisc& disc,
                            const NodeSearch& search) {
    return NodeFinder(band, disc, search).find();
}

}  // namespace lensproof
