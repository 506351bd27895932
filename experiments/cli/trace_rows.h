// experiments/cli/trace_rows.h — what `lensproof trace` says of a ray at a surface.
#pragma once
#include <fmt/format.h>

#include <optional>
#include <string>

#include "engine/base/json.h"
#include "engine/optics/polarised_ray.h"

namespace lensproof::cli {

inline constexpr const char* kTraceHeader = "id,surface,x_mm,y_mm,z_mm,dx,dy,dz,optical_path_mm,transmittance,status";

/// The columns that --polarised adds.
inline constexpr const char* kPolarisedHeader =
    ",polarised_transmittance,sagittal_transmittance,tangential_transmittance,degree_of_polarisation";

/// A ray at a surface, in whatever precision.
template <class T>
struct TraceRow {
    const std::string& id;
    std::string surface;
    Ray<T> ray;
    T optical_path;
    T transmittance;
    optics::RayStatus status;
    std::optional<optics::PolarisedLight<T>> polarised{};
};

template <class T>
std::string csv_of(const TraceRow<T>& row) {
    std::string line =
        fmt::format("{},{},{},{},{},{},{},{},{},{},{}", row.id, row.surface, row.ray.origin.x, row.ray.origin.y,
                    row.ray.origin.z, row.ray.direction.x, row.ray.direction.y, row.ray.direction.z, row.optical_path,
                    row.transmittance, optics::status_name(row.status));
    if (row.polarised) {
        line += fmt::format(",{},{},{},{}", row.polarised->unpolarised(), row.polarised->sagittal(),
                            row.polarised->tangential(), row.polarised->degree());
    }
    return line + "\n";
}

/// A field's three components, each its real and its imaginary part.
template <class Field>
Json field_json(const Field& field) {
    Json list = Json::list();
    for (const auto& component : field) {
        list.push_back({component.real(), component.imag()});
    }
    return list;
}

template <class T>
Json json_of(const TraceRow<T>& row) {
    Json json{{"id", row.id},
              {"surface", row.surface},
              {"point_mm", {row.ray.origin.x, row.ray.origin.y, row.ray.origin.z}},
              {"direction", {row.ray.direction.x, row.ray.direction.y, row.ray.direction.z}},
              {"optical_path_mm", row.optical_path},
              {"transmittance", row.transmittance},
              {"status", optics::status_name(row.status)}};
    if (row.polarised) {
        json["polarised_transmittance"] = row.polarised->unpolarised();
        json["sagittal_transmittance"] = row.polarised->sagittal();
        json["tangential_transmittance"] = row.polarised->tangential();
        json["degree_of_polarisation"] = row.polarised->degree();
        json["sagittal_field"] = field_json(row.polarised->of_sagittal);
        json["tangential_field"] = field_json(row.polarised->of_tangential);
    }
    return json;
}

}  // namespace lensproof::cli
