#include "engine/scene/geometry/gltf_check.h"

#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <vector>

#include "engine/base/input_error.h"
#include "engine/base/json.h"
#include "engine/base/text.h"
#include "engine/scene/geometry/gltf_document.h"

namespace lensproof::scene {

namespace {

constexpr std::size_t kDeepest = 256;
constexpr std::size_t kMostNodes = 250'000;

/// The nodes as a list of those below each.
class NodeTree {
  public:
    NodeTree(const Json& top, std::string file) : file_(std::move(file)) {
        const std::size_t nodes = top["nodes"].size();
        const auto indices = [&](const Json& list) {
            std::vector<std::size_t> found;
            for (const Json& entry : list) {
                if (entry.is_number() && entry.number() >= 0.0 && entry.number() < static_cast<double>(nodes)) {
                    found.push_back(static_cast<std::size_t>(entry.number()));
                }
            }
            return found;
        };
        for (const Json& node : top["nodes"]) {
            below_.push_back(indices(node["children"]));
        }
        for (const Json& scene : top["scenes"]) {
            scenes_.push_back(indices(scene["nodes"]));
        }
    }

    void check() const {
        std::vector<Extent> extents(below_.size());
        for (std::size_t node = 0; node < below_.size(); ++node) {
            measure(node, extents);
        }
        for (const std::vector<std::size_t>& scene : scenes_) {
            std::size_t nodes = 0;
            for (const std::size_t root : scene) {
                nodes = std::min(nodes + extents[root].nodes, kMostNodes + 1);
            }
            refuse_many(nodes);
        }
    }

  private:
    /// A node with all below it, shared ones as often as they are shared.
    struct Extent {
        std::size_t nodes = 0;  // 0: not yet known
        std::size_t levels = 0;
    };

    /// Of a node and all below it, each once. Kept on a stack of its own; on it a node twice would be inside itself.
    void measure(std::size_t root, std::vector<Extent>& extents) const {
        struct Open {
            std::size_t node;
            std::size_t next = 0;  // of those below it
            Extent sum{1, 1};
        };
        if (extents[root].nodes > 0) {
            return;
        }
        std::vector<Open> open{{root}};
        while (!open.empty()) {
            if (open.size() > kDeepest) {
                refuse(fmt::format("holds nodes more than {} deep, or one inside itself", kDeepest));
            }
            Open& at = open.back();
            if (at.next == below_[at.node].size()) {
                refuse_many(at.sum.nodes);
                extents[at.node] = at.sum;
                open.pop_back();
                continue;
            }
            const std::size_t child = below_[at.node][at.next];
            if (extents[child].nodes == 0) {
                open.push_back({child});
                continue;
            }
            at.sum.nodes += extents[child].nodes;
            at.sum.levels = std::max(at.sum.levels, extents[child].levels + 1);
            refuse_many(at.sum.nodes);
            if (at.sum.levels > kDeepest) {
                refuse(fmt::format("holds nodes more than {} deep", kDeepest));
            }
            ++at.next;
        }
    }

    void refuse_many(std::size_t nodes) const {
        if (nodes > kMostNodes) {
            refuse(fmt::format("asks for more than {} nodes, those that others share counted for each", kMostNodes));
        }
    }
    [[noreturn]] void refuse(const std::string& why) const { throw InputError(fmt::format("{}: {}", file_, why)); }

    std::string file_;
    std::vector<std::vector<std::size_t>> below_;
    std::vector<std::vector<std::size_t>> scenes_;
};

}  // namespace

void check_gltf(const std::filesystem::path& file) {
    const Json top = gltf_json(file);
    NodeTree(top, file.string()).check();
    for (const Json& buffer : top["buffers"]) {
        // Assimp looks for what follows this mark also where nothing does.
        if (const Json& uri = buffer["uri"]; uri.is_text() && uri.text().find("://") != std::string::npos) {
            throw InputError(
                fmt::format("{}: names {}, expected a file beside it", file.string(), printable(uri.text())));
        }
    }
}

}  // namespace lensproof::scene
