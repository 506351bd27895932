#include "experiments/cli/compare_report.h"

#include <fmt/format.h>

#include <cmath>

#include "engine/base/input_error.h"
#include "experiments/cli/terminal.h"

namespace lensproof::cli {

int report_rows(const std::vector<ComparedRow>& rows, const std::string& a, const std::string& b,
                const CommonOptions& common, Json& json) {
    int status = kDone;
    json["differences"] = Json::list();
    for (const ComparedRow& row : rows) {
        const findings::Check& check = row.check;
        if (!std::isfinite(check.value)) {
            if (row.limited) {
                throw InputError(
                    fmt::format("{} and {}: their difference in {} is {}, expected a finite number to "
                                "hold against its limit",
                                a, b, check.label, check.value));
            }
            continue;
        }
        const findings::Verdict verdict = check.verdict();
        Json entry{{"quantity", check.label},
                   {"rms" + row.key_suffix, check.value},
                   {"standard_error" + row.key_suffix, check.sigma}};
        if (row.limited) {
            entry["limit" + row.key_suffix] = check.limit;
            entry["verdict"] = findings::verdict_name(verdict);
            status = verdict == findings::Verdict::pass ? status : kCheckFailed;
        }
        json["differences"].push_back(entry);
        if (prints_text(common)) {
            print("{:32} rms {:.5g} ± {:.2g} {}{}\n", check.label, check.value, check.sigma, check.unit,
                  row.limited ? fmt::format("  limit {:g}: {}", check.limit, findings::verdict_name(verdict))
                              : std::string());
        }
    }
    return status;
}

}  // namespace lensproof::cli
