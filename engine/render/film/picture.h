// engine/render/film/picture.h — the films that a picture is the sum of.
#pragma once
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "engine/render/film/film.h"

namespace lensproof::render {

/// What one pass has made of a picture. A picture of one film has no name for it.
struct PassFilm {
    std::string pass;
    Film film;
};

/// Looks at films of one size, with the same layers, that add up to a picture. They outlive it.
class Picture {
  public:
    struct Part {
        std::string pass;
        const Film* film = nullptr;
    };

    Picture(const Film& film) : parts_{{"", &film}} {}  // NOLINT(google-explicit-constructor): a film is a picture
    explicit Picture(std::vector<Part> parts) : parts_(std::move(parts)) {}
    explicit Picture(const std::vector<PassFilm>& films);

    [[nodiscard]] const std::vector<Part>& parts() const { return parts_; }
    [[nodiscard]] const FilmLayout& layout() const { return parts_.front().film->layout(); }
    [[nodiscard]] int width() const { return layout().width; }
    [[nodiscard]] int height() const { return layout().height; }
    [[nodiscard]] std::uint64_t left_out() const;

    /// Of all films together, whose samples are independent of each other.
    [[nodiscard]] PixelEstimate estimate(int x, int y) const;
    void layers(int x, int y, std::span<double> irradiance) const;

  private:
    std::vector<Part> parts_;
};

}  // namespace lensproof::render
