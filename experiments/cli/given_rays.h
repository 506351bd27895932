// experiments/cli/given_rays.h — the rays that `lensproof trace` is given.
#pragma once
#include <optional>
#include <string>

#include "engine/base/csv.h"
#include "engine/base/ray.h"

namespace lensproof::cli {

struct GivenRay {
    std::string id;
    Ray<double> ray;  // its direction not yet of unit length
    double wavelength_nm = 0.0;
};

/// Throws InputError naming the place in the file.
GivenRay read_ray(const CsvRow& row);

/// Rays of a table, read anew each time that they are asked for.
class GivenRays {
  public:
    /// Throws InputError where the file is no such table, or has no ray.
    explicit GivenRays(const std::string& file);

    template <class Visit>
    void for_each(const Visit& visit) const {
        for_each_row([&](const CsvRow& row) { visit(read_ray(row)); });
    }

    template <class Visit>
    void for_each_row(const Visit& visit) const {
        CsvTable table = table_;
        while (const std::optional<CsvRow> row = table.next()) {
            visit(*row);
        }
    }

  private:
    CsvTable table_;
};

}  // namespace lensproof::cli
