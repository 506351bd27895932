#include "engine/optics/air.h"

namespace lensproof::optics {

namespace {

constexpr double kZeroCelsius = 273.15;
constexpr double kStandardTemperature = 15.0 + kZeroCelsius;
constexpr double kStandardPressure = 101325.0;

}  // namespace

double standard_air_index(double vacuum_wavelength_nm) {
    const double sigma = 1e3 / vacuum_wavelength_nm;
    const double squared = sigma * sigma;
    return 1.0 + 1e-8 * (5792105.0 / (238.0185 - squared) + 167917.0 / (57.362 - squared));
}

double air_index(double vacuum_wavelength_nm, double temperature_C, double pressure_Pa) {
    const double density = pressure_Pa / kStandardPressure * kStandardTemperature / (temperature_C + kZeroCelsius);
    return 1.0 + (standard_air_index(vacuum_wavelength_nm) - 1.0) * density;
}

double vacuum_wavelength_nm(double air_wavelength_nm) {
    // The index changes by 1e-8 over the shift of 2e-4 nm that the first step leaves.
    const double first = air_wavelength_nm * standard_air_index(air_wavelength_nm);
    return air_wavelength_nm * standard_air_index(first);
}

double air_wavelength_nm(double vacuum_wavelength_nm) {
    return vacuum_wavelength_nm / standard_air_index(vacuum_wavelength_nm);
}

double absolute_index(double index_relative_to_air, double air_wavelength_nm, double temperature_C) {
    return index_relative_to_air * air_index(vacuum_wavelength_nm(air_wavelength_nm), temperature_C);
}

}  // namespace lensproof::optics
