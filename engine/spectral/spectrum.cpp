#include "engine/spectral/spectrum.h"

#include <algorithm>
#include <iterator>

namespace lensproof::spectral {

double Spectrum::operator()(double at_nm) const {
    const auto after = std::upper_bound(wavelength_nm.begin(), wavelength_nm.end(), at_nm);
    if (after == wavelength_nm.begin()) {
        return 0.0;
    }
    const auto i = static_cast<std::size_t>(after - wavelength_nm.begin()) - 1;
    if (after == wavelength_nm.end()) {
        return at_nm == wavelength_nm[i] ? value[i] : 0.0;
    }
    const double fraction = (at_nm - wavelength_nm[i]) / (wavelength_nm[i + 1] - wavelength_nm[i]);
    return value[i] + fraction * (value[i + 1] - value[i]);
}

Spectrum operator*(double scale, Spectrum spectrum) {
    for (double& value : spectrum.value) {
        value *= scale;
    }
    return spectrum;
}

Spectrum clipped(const Spectrum& spectrum, double from_nm, double to_nm) {
    if (spectrum.wavelength_nm.empty()) {
        return {};
    }
    const double first_nm = std::max(from_nm, spectrum.wavelength_nm.front());
    const double last_nm = std::min(to_nm, spectrum.wavelength_nm.back());
    if (!(first_nm < last_nm)) {
        return {};
    }
    Spectrum inside{.wavelength_nm = {first_nm}, .value = {spectrum(first_nm)}};
    for (std::size_t i = 0; i < spectrum.wavelength_nm.size(); ++i) {
        if (spectrum.wavelength_nm[i] > first_nm && spectrum.wavelength_nm[i] < last_nm) {
            inside.wavelength_nm.push_back(spectrum.wavelength_nm[i]);
            inside.value.push_back(spectrum.value[i]);
        }
    }
    inside.wavelength_nm.push_back(last_nm);
    inside.value.push_back(spectrum(last_nm));
    return inside;
}

double integral(const Spectrum& spectrum) {
    if (spectrum.wavelength_nm.empty()) {
        return 0.0;
    }
    return integral(spectrum, spectrum.wavelength_nm.front(), spectrum.wavelength_nm.back());
}

double integral(const Spectrum& spectrum, double from_nm, double to_nm) {
    return integral_of_product(spectrum, {.wavelength_nm = {from_nm, to_nm}, .value = {1.0, 1.0}});
}

double integral_of_product(const Spectrum& a, const Spectrum& b) {
    if (a.wavelength_nm.empty() || b.wavelength_nm.empty()) {
        return 0.0;
    }
    const double from_nm = std::max(a.wavelength_nm.front(), b.wavelength_nm.front());
    const double to_nm = std::min(a.wavelength_nm.back(), b.wavelength_nm.back());
    std::vector<double> knots;
    std::merge(a.wavelength_nm.begin(), a.wavelength_nm.end(), b.wavelength_nm.begin(), b.wavelength_nm.end(),
               std::back_inserter(knots));
    const auto product = [&](double at_nm) { return a(at_nm) * b(at_nm); };
    double sum = 0.0;
    for (std::size_t i = 0; i + 1 < knots.size(); ++i) {
        const double left = knots[i];
        const double right = knots[i + 1];
        if (left >= from_nm && right <= to_nm && left < right) {
            sum += (right - left) / 6.0 * (product(left) + 4.0 * product(0.5 * (left + right)) + product(right));
        }
    }
    return sum;
}

}  // namespace lensproof::spectral
