// engine/render/sampling/pixel_filter.h — how the light near a pixel's centre makes the pixel.
#pragma once
#include <string>
#include <vector>

namespace lensproof::render {

/// A pixel's value is ∫∫ E(x, y) f(x − u) f(y − v) dx dy over the film, in px: (u, v) is the pixel's centre, E the film
/// irradiance, f the filter along one axis, of integral 1.
///
///   box               the pixel's own area: what a sensor without gaps sees. The default.
///   tent              1 − |x|, |x| < 1
///   gaussian          exp(−2 x²), less its value at the end, |x| < 1.5
///   blackman-harris   the four-term window of F. J. Harris, Proc. IEEE 66(1), 1978, over |x| < 1.5
///   mitchell          the cubic with B = C = 1/3 of Mitchell & Netravali, SIGGRAPH 1988, |x| < 2; negative beyond 1.1
///
/// Camera paths draw their film point from the filter ("filter importance sampling", Ernst, Stamminger & Greiner,
/// RT 2006) and so belong to one pixel: the noise of pixels stays independent, tiles need no borders, and any pixel may
/// have more samples than its neighbour. Light that lands anywhere is spread over the pixels whose filters reach it,
/// which then share its noise: beyond the box, that of neighbours correlates as the filter does with itself, shifted.
/// Both estimate the same integral without bias.
class PixelFilter {
  public:
    /// The box.
    PixelFilter() = default;

    /// One of the above. Throws InputError for another name, listing these.
    static PixelFilter named(const std::string& name);
    static std::vector<std::string> known_names();

    /// What a pixel sees whose light-sensitive part is a centred square of a `fraction` of its area, in (0, 1], with
    /// nothing to bring the rest of the light there: a box of side √fraction px. It is the sharper for it, by
    /// sinc(√fraction f) in place of sinc(f) at f cycles a pixel, and aliases the more.
    static PixelFilter square(double fraction);

    [[nodiscard]] const std::string& name() const { return name_; }
    [[nodiscard]] bool is_box() const { return quantile_.empty(); }
    /// Beyond it f is 0, px.
    [[nodiscard]] double radius_px() const { return radius_px_; }

    /// f, 1/px. The box has its lower end and not its upper one, so that each point is in one pixel.
    [[nodiscard]] double operator()(double offset_px) const;

    /// An offset from the centre and f there over the pdf that it was drawn with: about 1, or about −1 in a
    /// negative lobe times what that costs. `u` in (0, 1).
    struct Draw {
        double offset_px = 0.0;
        double weight = 1.0;
    };
    [[nodiscard]] Draw draw(double u) const;

  private:
    using Shape = double (*)(double offset_px);

    PixelFilter(std::string name, Shape shape, double radius_px);

    std::string name_ = "box";
    Shape shape_ = nullptr;
    double scale_ = 1.0;  // makes the integral 1
    double radius_px_ = 0.5;
    std::vector<double> quantile_;  // offsets that cut ∫ |f| into equal parts, both ends included; none for the box
};

}  // namespace lensproof::render
