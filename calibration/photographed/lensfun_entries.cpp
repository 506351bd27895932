#include "calibration/photographed/lensfun_entries.h"

#include <fmt/format.h>

#include "engine/base/json_node.h"
#include "engine/base/markup.h"

namespace lensproof::calibration {

namespace {

std::string element(const char* name, const std::string& text) {
    return fmt::format("<{0}>{1}</{0}>\n", name, escape_markup(text));
}

/// Text or number, as it stands.
std::string spelled(const JsonNode& node) {
    return node.value().is_number() ? fmt::format("{}", node.number()) : node.text();
}

std::string calibrations(const JsonNode& entry, const char* key, const char* name) {
    std::string xml;
    if (!entry.has(key)) {
        return xml;
    }
    for (const JsonNode& calibration : entry.at(key).elements()) {
        xml += fmt::format("<{}", name);
        for (const std::string& attribute : calibration.keys()) {
            if (attribute == "real-focal") {  // which lensfun 0.3.3 does not know, and no scale here needs
                continue;
            }
            xml +=
                fmt::format(" {}=\"{}\"", escape_markup(attribute), escape_markup(spelled(calibration.at(attribute))));
        }
        xml += "/>\n";
    }
    return xml;
}

std::string lens_element(const JsonNode& entry) {
    std::string xml = "<lens>\n" + element("maker", entry.at("maker").text());
    const std::vector<JsonNode> models = entry.at("models").elements();
    for (std::size_t i = 0; i < models.size(); ++i) {
        // lensfun tells names of one entry apart by their languages; which language it is does not matter here.
        xml += i == 0 ? element("model", models[i].text())
                      : fmt::format("<model lang=\"x{}\">{}</model>\n", i, escape_markup(models[i].text()));
    }
    for (const JsonNode& mount : entry.at("mounts").elements()) {
        xml += element("mount", mount.text());
    }
    xml += element("cropfactor", spelled(entry.at("crop")));
    if (entry.has("aspect")) {
        xml += element("aspect-ratio", spelled(entry.at("aspect")));
    }
    if (entry.has("type")) {
        xml += element("type", entry.at("type").text());
    }
    return xml + "<calibration>\n" + calibrations(entry, "dist", "distortion") + calibrations(entry, "tca", "tca") +
           calibrations(entry, "vig", "vignetting") + "</calibration>\n</lens>\n";
}

}  // namespace

std::vector<std::string> lensfun_xml(std::string_view json, const std::filesystem::path& file) {
    const JsonNode top = JsonNode::parse(json, file.string());
    std::vector<std::string> databases;
    for (const JsonNode& entry : top.at("entries").elements()) {
        databases.push_back("<!DOCTYPE lensdatabase SYSTEM \"lensfun-database.dtd\">\n<lensdatabase version=\"1\">\n" +
                            lens_element(entry) + "</lensdatabase>\n");
    }
    return databases;
}

}  // namespace lensproof::calibration
