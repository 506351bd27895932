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
    const auto per_panel = add(tables_.per_panel, pupil::PupilSliceTables::kPanels);
    const auto directions = add(&sampler_detail::kDirections, 1);
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
    tables_.per_panel = parcel_.address(per_panel);
    directions_ = parcel_.address(directions);
}

namespace {

/// Calls use(column) with each column's place in any set of them.
template <class Use>
void for_each_column(const Use& use) {
    use(&DevicePathColumns::fate);
    use(&DevicePathColumns::wavelength);
    use(&DevicePathColumns::film_x);
    use(&DevicePathColumns::film_y);
    use(&DevicePathColumns::weight);
    use(&DevicePathColumns::etendue);
    use(&DevicePathColumns::x);
    use(&DevicePathColumns::y);
    use(&DevicePathColumns::z);
    use(&DevicePathColumns::dx);
    use(&DevicePathColumns::dy);
    use(&DevicePathColumns::dz);
}

std::size_t column_bytes(std::size_t paths) {
    std::size_t bytes = 0;
    for_each_column([&]<class Number>(Number* DevicePathColumns::* /*column*/) {
        bytes += device::Buffer::bytes_for<Number>(paths);
    });
    return bytes;
}

}  // namespace

template <class T>
DevicePaths<T>::Piece::Piece(const device::Device& device) : buffer(device, column_bytes(kPiece)) {}

template <class T>
DevicePaths<T>::DevicePaths(device::SharedDevice& device, const DeviceCamera<T>& camera, const FilmSampling& film,
                            double pupil_z, BasicLensPaths<T> fallback)
    : device_(&device), camera_(&camera), film_(film), pupil_z_(pupil_z), fallback_(std::move(fallback)) {}

template <class T>
void DevicePaths<T>::start(const CameraPathRange& range) {
    range_ = range;
    started_pieces_ = 0;
    given_ = 0;
    current_ = 0;
    if (!device_->has_failed()) {
        try {
            if (!pieces_) {
                pieces_.emplace(std::array<Piece, 2>{Piece(device_->device()), Piece(device_->device())});
            }
            for (Piece& piece : *pieces_) {
                start_piece(piece);
            }
            return;
        } catch (const device::Error& error) {
            device_->fail(error.what());
        }
    }
    pieces_.reset();
    fallback_.start(range);
}

template <class T>
void DevicePaths<T>::start_piece(Piece& piece) {
    piece.first = started_pieces_;
    piece.size = static_cast<std::size_t>(std::min<std::uint64_t>(kPiece, range_.size() - started_pieces_));
    piece.next = 0;
    piece.is_here = false;
    started_pieces_ += piece.size;
    if (piece.size == 0) {
        return;
    }
    piece.buffer.clear();
    for_each_column([&]<class Number>(Number* DevicePathColumns::*column) {
        const device::Column<Number> made = piece.buffer.template column<Number>(piece.size);
        piece.here.*column = made.here;
        piece.there.*column = made.there;
    });
    const auto run = [&]<bool has_specials>() {
        piece.buffer.queue().run(PathJob<T, has_specials>{.lens = camera_->lens(),
                                                          .pupil = camera_->pupil(),
                                                          .pupil_z = pupil_z_,
                                                          .film_z = static_cast<double>(camera_->lens().image_z),
                                                          .directions = camera_->directions(),
                                                          .sensor = film_.sensor,
                                                          .seed = film_.seed,
                                                          .range = range_,
                                                          .first = piece.first,
                                                          .paths = piece.there},
                                 static_cast<int>(piece.size));
    };
    camera_->lens().has_more_than_spheres() ? run.template operator()<true>() : run.template operator()<false>();
    piece.buffer.download();
}

template <class T>
void DevicePaths<T>::give(Piece& piece, CameraPathBuffer& buffer) {
    const DevicePathColumns& from = piece.here;
    std::size_t next = piece.next;
    for (; next < piece.size && buffer.size < buffer.capacity; ++next) {
        if (from.fate[next] != PathFate::leaves) {
            started_ += from.fate[next] == PathFate::stopped ? 1 : 0;
            continue;
        }
        ++started_;
        const CameraPathRange::Place place = range_.place(piece.first + next);
        const auto to = static_cast<std::size_t>(buffer.size++);
        buffer.pixel[to] = place.pixel;
        buffer.sample[to] = range_.first_sample + place.sample;
        buffer.wavelength[to] = from.wavelength[next];
        buffer.film_x[to] = from.film_x[next];
        buffer.film_y[to] = from.film_y[next];
        buffer.weight[to] = from.weight[next];
        buffer.etendue[to] = from.etendue[next];
        buffer.origin.x[to] = from.x[next];
        buffer.origin.y[to] = from.y[next];
        buffer.origin.z[to] = from.z[next];
        buffer.direction.x[to] = from.dx[next];
        buffer.direction.y[to] = from.dy[next];
        buffer.direction.z[to] = from.dz[next];
    }
    given_ += next - piece.next;
    piece.next = next;
}

template <class T>
void DevicePaths<T>::fill_from_device(CameraPathBuffer& buffer) {
    while (given_ < range_.size() && buffer.size < buffer.capacity) {
        Piece& piece = (*pieces_)[current_];
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
    if (pieces_) {
        buffer.size = 0;
        try {
            fill_from_device(buffer);
            return buffer.size > 0;
        } catch (const device::Error& error) {
            device_->fail(error.what());
        }
        pieces_.reset();
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
