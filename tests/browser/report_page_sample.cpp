// tests/browser/report_page_sample.cpp — report.json and a folder of PNGs in, report.html out.
//     report_page_sample report.json pictures/ report.html
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <string>

#include "engine/base/json.h"
#include "experiments/draw/report/report.h"

namespace {

std::string bytes_of(const std::filesystem::path& file) {
    std::ifstream in(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
}

}  // namespace

int main(int argc, char** argv) {
    if (argc != 4) return 2;
    const std::filesystem::path pictures = argv[2];
    std::map<std::string, std::string> png_bytes_by_name;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(pictures)) {
        if (entry.path().extension() != ".png") continue;
        png_bytes_by_name[entry.path().lexically_relative(pictures).generic_string()] = bytes_of(entry.path());
    }
    std::ofstream(argv[3], std::ios::binary)
        << lensproof::draw::report_html(lensproof::Json::parse(bytes_of(argv[1]), argv[1]), png_bytes_by_name);
    return 0;
}
