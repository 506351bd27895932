// engine/formats/image/image.h — pictures in memory, as files, and the transfer curve between the two.
#pragma once
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace lensproof::formats {

/// A picture in linear light: `channels.size()` floats a pixel, rows from the top, pixels from the left.
///
/// Pixel coordinates, here and in every file of the project: the centre of the top-left pixel is (0, 0), x runs to the
/// right and y down, so the picture covers [-0.5, width - 0.5] × [-0.5, height - 0.5] (OpenCV's convention).
struct Image {
    int width = 0;
    int height = 0;
    std::vector<std::string> channels;  // "R", "G", "B"; "Y" for grey; "S0.550,5nm" for a spectral layer
    std::vector<float> pixels;
    std::map<std::string, std::string> metadata;

    [[nodiscard]] int channel_count() const { return static_cast<int>(channels.size()); }
    [[nodiscard]] float& at(int x, int y, int channel) { return pixels[offset(x, y) + channel]; }
    [[nodiscard]] float at(int x, int y, int channel) const { return pixels[offset(x, y) + channel]; }

  private:
    [[nodiscard]] std::size_t offset(int x, int y) const {
        return (static_cast<std::size_t>(y) * width + x) * channels.size();
    }
};

/// A black picture of the given size.
Image make_image(int width, int height, std::vector<std::string> channels);

/// The index of the channel called `name`, or -1.
int find_channel(const Image& image, const std::string& name);

/// Reads a picture and linearises it: float formats (EXR) are linear already, integer formats are taken as sRGB unless
/// the file states another gamma. Full scale is 1. EXIF orientation is applied; an alpha channel is dropped.
/// Throws InputError for a file that is missing, not a picture (JPEG, PNG, TIFF, EXR, Radiance HDR, a camera's raw
/// file, whatever its name), truncated, larger than 2·10⁹ values, or than `largest_picture_mib` says.
Image read_image(const std::filesystem::path& file);

/// The most memory that a picture's numbers may take, MiB, where it is set: before any picture is read, by the command
/// line. Otherwise a picture has at most 200 million pixels and takes at most half of the memory that there is; and of
/// more than 2²⁶ numbers it has at most 300 for a byte of its file. (Deflate makes at most 1032 bytes of one, which are
/// 258 numbers of 32 bits; cameras' JPEGs come to 30 of 8 bits.)
std::optional<double>& largest_picture_mib();

/// Writes a linear EXR (32-bit float, every channel, metadata as attributes); whole or not at all.
void write_exr(const Image& image, const std::filesystem::path& file);

/// Writes an 8-bit sRGB PNG of the R, G, B (or Y) channels; values above 1 saturate. Whole or not at all.
void write_png(const Image& image, const std::filesystem::path& file);

/// The same with 16 bits.
void write_png_16(const Image& image, const std::filesystem::path& file);

/// Integers as a device gave them: `channels` a pixel, 1 or 3, rows from the top.
struct IntegerImage {
    int width = 0;
    int height = 0;
    int channels = 1;
    std::vector<std::uint16_t> values;
    std::map<std::string, std::string> metadata;
};

/// Writes the integers as they are as a 16-bit PNG that states linear light, metadata as its texts. Whole or not at
/// all.
void write_png(const IntegerImage& image, const std::filesystem::path& file);

/// The 8-bit sRGB PNG as bytes, for a report that holds its pictures inside.
std::string encode_png(const Image& image);

/// The same as a JPEG of that quality, colours at full resolution: where many photos are to be looked at and none is to
/// be measured.
std::string encode_jpeg(const Image& image, int quality = 88);

}  // namespace lensproof::formats
