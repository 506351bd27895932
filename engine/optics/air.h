// engine/optics/air.h — standard air, and the step between indices relative to it and to vacuum.
#pragma once

namespace lensproof::optics {

/// The phase index of standard air (dry, 15 °C, 101 325 Pa, 450 ppm CO2) at a wavelength in vacuum, nm:
///     10⁸ (n − 1) = 5 792 105 / (238.0185 − σ²) + 167 917 / (57.362 − σ²),  σ = 1/λ in µm⁻¹
/// (Ciddor, Appl. Opt. 35, 1566, 1996, eq. 1; stated for 300 to 1690 nm, uncertain by 2e-8).
double standard_air_index(double vacuum_wavelength_nm);

/// The same at temperature (°C) and pressure (Pa), n − 1 being proportional to the density of an ideal gas: right to
/// 5e-8 from 10 to 30 °C and 80 to 120 kPa.
double air_index(double vacuum_wavelength_nm, double temperature_C, double pressure_Pa = 101325.0);

/// The wavelength in vacuum, nm, of light that has the wavelength `air_wavelength_nm` in standard air; and back.
double vacuum_wavelength_nm(double air_wavelength_nm);
double air_wavelength_nm(double vacuum_wavelength_nm);

/// A catalogue's index, which is relative to air at the wavelength in air, as an index against vacuum. The catalogue's
/// air is at `temperature_C`, its reference temperature.
double absolute_index(double index_relative_to_air, double air_wavelength_nm, double temperature_C = 20.0);

}  // namespace lensproof::optics
