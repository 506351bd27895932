#include "engine/render/camera/device_paths.h"

#include <algorithm>
#include <utility>

namespace lensproof::render {

template <class T>
DeviceCamera<T>::DeviceCamera(const device::Device& device, const optics::SpectralLens<T>& lens,
                              const pupil::PupilSlices& pupil)
    : lens_(device, lens), tables_(*pupil.tables()) {
    const pupil::PupilSlices::TableSizes sizes = pupil.table_sizes();
    const auto add = [&]<class Entry>(const Entry* table, std::size_t size) {
        return parcel_.add(std::span<const Entry>(table, size));
    };
    const auto per_end = add(tables_.per_end, sizes.slices);
    const auto fractions = add(tables_.fractions, sizes.nodes);
    const auto per_step = add(tables_.per_step, sizes.nodes - 1);
    const auto node_below = add(tables_.node_below, sizes.node_below);
    const auto regions = add(tables_.regions, sizes.regions);
    const auto panel_below = add(tables_.panel_below, sizes.panel_below);
    const auto panel_fractions = add(tables_.panel_fractions, pupil::PupilSliceTables::kPanels + 1);
    const auto panel_across = add(tables_.panel_across, sizes.panel_across);
    const auto next_panel = add(tables_.next_panel, sizes.panel_across);
    const auto per_panel = add(tables_.per_panel, pupil::PupilSliceTables::kPanels);
    const auto sobol_points = add(&sampler_detail::kDigitPoints, 1);
    parcel_.allocate(device);
    parcel_.send(device);
    tables_.per_end = parcel_.address(per_end);
    tables_.fractions = parcel_.address(fractions);
    tables_.per_step = parcel_.address(per_step);
    tables_.node_below = parcel_.address(node_below);
    tables_.regions = parcel_.address(regions);
    tables_.panel_below = parcel_.address(panel_below);
    tables_.panel_fractions = parcel_.address(panel_fractions);
    tables_.panel_across = parcel_.address(panel_across);
    tables_.next_panel = parcel_.address(next_panel);
    tables_.per_panel = parcel_.address(per_panel);
    sobol_points_ = parcel_.address(sobol_points);
}

namespace {

/// Calls use(column) with each column's place in any set of them.
template <class Use>
void for_each_column(bool has_film, const Use& use) {
    use(&DevicePathColumns::fate);
    use(&DevicePathColumns::wavelength);
    if (has_film) {
        use(&DevicePathColumns::film_x);
        use(&DevicePathColumns::film_y);
        use(&DevicePathColumns::etendue);
    }
    use(&DevicePathColumns::weight);
    use(&DevicePathColumns::x);
    use(&DevicePathColumns::y);
    use(&DevicePathColumns::z);
    use(&DevicePathColumns::dx);
    use(&DevicePathColumns::dy);
    use(&DevicePathColumns::dz);
}

std::size_t column_bytes(std::size_t paths) {
    std::size_t bytes = 0;
    for_each_column(true, [&]<class Number>(Number* DevicePathColumns::* /*column*/) {
        bytes += device::Buffer::bytes_for<Number>(paths);
    });
    return bytes;
}

}  // namespace

DevicePathPiece::DevicePathPiece(const device::Device& device) : buffer(device, column_bytes(kMost)) {}

std::unique_ptr<DevicePathPiece> SparePathPieces::take(const device::Device& device) {
    {
        const std::scoped_lock lock(mutex_);
        if (!spare_.empty()) {
            std::unique_ptr<DevicePathPiece> piece = std::move(spare_.back());
            spare_.pop_back();
            return piece;
        }
    }
    return std::make_unique<DevicePathPiece>(device);
}

void SparePathPieces::give_back(std::unique_ptr<DevicePathPiece> piece) {
    if (piece) {
        const std::scoped_lock lock(mutex_);
        spare_.push_back(std::move(piece));
    }
}

template <class T>
DevicePaths<T>::DevicePaths(device::SharedDevice& device, const DeviceCamera<T>& camera, const FilmSampling& film,
                            double pupil_z, bool has_film, BasicLensPaths<T> fallback)
    : fallback_(std::move(fallback)),
      device_(&device),
      camera_(&camera),
      film_(film),
      pupil_z_(pupil_z),
      has_film_(has_film) {}

template <class T>
DevicePaths<T>::~DevicePaths() {
    for (std::unique_ptr<Piece>& piece : pieces_) {
        camera_->spare_pieces().give_back(std::move(piece));
    }
}

template <class T>
void DevicePaths<T>::start(const CameraPathRange& range) {
    range_ = range;
    started_pieces_ = 0;
    given_ = 0;
    current_ = 0;
    if (!device_->has_failed()) {
        try {
            for (std::unique_ptr<Piece>& piece : pieces_) {
                if (!piece) {
                    piece = camera_->spare_pieces().take(device_->device());
                }
                start_piece(*piece);
            }
            return;
        } catch (const device::Error& error) {
            device_->fail(error.what());
        }
    }
    pieces_ = {};
    fallback_.start(range);
}

template <class T>
void DevicePaths<T>::start_piece(Piece& piece) {
    piece.first = started_pieces_;
    piece.size = static_cast<std::size_t>(std::min<std::uint64_t>(Piece::kMost, range_.size() - started_pieces_));
    piece.next = 0;
    piece.is_here = false;
    started_pieces_ += piece.size;
    if (piece.size == 0) {
        return;
    }
    piece.buffer.clear();
    piece.there = {};
    for_each_column(has_film_, [&]<class Number>(Number* DevicePathColumns::*column) {
        const device::Column<Number> made = piece.buffer.template column<Number>(piece.size);
        piece.here.*column = made.here;
        piece.there.*column = made.there;
    });
    const auto run = [&]<optics::LensMakeup makeup>() {
        piece.buffer.queue().run(PathJob<T, makeup>{.lens = camera_->lens(),
                                                    .pupil = camera_->pupil(),
                                                    .pupil_z = pupil_z_,
                                                    .film_z = static_cast<double>(camera_->lens().image_z),
                                                    .sobol_points = camera_->sobol_points(),
                                                    .sensor = film_.sensor,
                                                    .seed = film_.seed,
                                                    .range = range_,
                                                    .first = piece.first,
                                                    .paths = piece.there},
                                 static_cast<int>(piece.size));
    };
    using enum optics::LensMakeup;
    switch (camera_->lens().makeup()) {
        case clear_spheres:
            run.template operator()<clear_spheres>();
            break;
        case spheres:
            run.template operator()<spheres>();
            break;
        case any:
            run.template operator()<any>();
            break;
    }
    piece.buffer.download();
}

template <class T>
void DevicePaths<T>::give(Piece& piece, CameraPathBuffer& buffer) {
    const DevicePathColumns& from = piece.here;
    const auto first = static_cast<std::size_t>(buffer.size);
    const auto room = static_cast<std::size_t>(buffer.capacity) - first;
    leaving_.resize(std::max(leaving_.size(), room));
    std::size_t leaving = 0;
    std::size_t next = piece.next;
    CameraPathRange::Place place = range_.place(piece.first + next);
    for (; next < piece.size && leaving < room; ++next, place = range_.after(place)) {
        started_ += from.fate[next] == PathFate::unlit ? 0 : 1;
        if (from.fate[next] == PathFate::leaves) {
            buffer.pixel[first + leaving] = place.pixel;
            buffer.sample[first + leaving] = range_.first_sample + place.sample;
            leaving_[leaving++] = static_cast<std::uint32_t>(next);
        }
    }
    // Column by column: plain loops, in which nothing is looked up twice.
    const auto copy = [&](const auto* column, auto& to) {
        auto* at = to.data() + first;
        const std::uint32_t* path = leaving_.data();
        for (std::size_t i = 0; i < leaving; ++i) {
            at[i] = column[path[i]];
        }
    };
    copy(from.wavelength, buffer.wavelength);
    if (has_film_) {
        copy(from.film_x, buffer.film_x);
        copy(from.film_y, buffer.film_y);
        copy(from.etendue, buffer.etendue);
    }
    copy(from.weight, buffer.weight);
    copy(from.x, buffer.origin.x);
    copy(from.y, buffer.origin.y);
    copy(from.z, buffer.origin.z);
    copy(from.dx, buffer.direction.x);
    copy(from.dy, buffer.direction.y);
    copy(from.dz, buffer.direction.z);
    buffer.size += static_cast<int>(leaving);
    given_ += next - piece.next;
    piece.next = next;
}

template <class T>
void DevicePaths<T>::fill_from_device(CameraPathBuffer& buffer) {
    while (given_ < range_.size() && buffer.size < buffer.capacity) {
        Piece& piece = *pieces_[current_];
        if (!piece.is_here) {
            piece.buffer.queue().wait();
            piece.is_here = true;
        }
        give(piece, buffer);
        if (piece.next == piece.size) {
            start_piece(piece);
            current_ = 1 - current_;
        }
    }
}

template <class T>
bool DevicePaths<T>::fill(CameraPathBuffer& buffer) {
    if (pieces_.front()) {
        buffer.size = 0;
        try {
            fill_from_device(buffer);
            return buffer.size > 0;
        } catch (const device::Error& error) {
            device_->fail(error.what());
        }
        pieces_ = {};
        fallback_.start(range_, given_);
        if (buffer.size > 0) {  // what the device gave before it failed
            return true;
        }
    }
    return fallback_.fill(buffer);
}

template class DeviceCamera<float>;
template class DeviceCamera<double>;
template class DevicePaths<float>;
template class DevicePaths<double>;

}  // namespace lensproof::render
