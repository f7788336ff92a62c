#include "cli/common.h"
#include "tree/tree.h"

#include <cstdio>
#include <memory>

namespace pcm::cli {
namespace {

struct Arguments {
    Common common;
    std::string tree;
};

int info(const Arguments& arguments)
{
    const auto tree = Tree::open(arguments.tree);
    const TreeInfo& info = tree->info();
    const Box3d bounds = info.bounds();
    const std::vector<LevelSummary> levels = tree->level_summaries();
    if (arguments.common.json) {
        Json json;
        json["tree"] = tree->folder().string();
        json["points"] = info.points;
        json["points_skipped"] = info.points_skipped;
        if (info.points) {
            json["bounds"] = {{"min", bounds.min}, {"max", bounds.max}};
        } else {
            json["bounds"] = nullptr;
        }
        json["scale"] = info.grid.scale;
        json["origin"] = info.grid.offset;
        json["position_type"] = name_of(info.position_type);
        json["position_error"] = info.position_error;
        json["attributes"] = Json::array();
        for (const Attribute& attribute : info.schema)
            json["attributes"].push_back({{"name", attribute.name},
                                          {"type", name_of(attribute.type)},
                                          {"components", attribute.components},
                                          {"scale", attribute.scale},
                                          {"offset", attribute.offset}});
        json["levels"] = info.levels;
        json["level"] = Json::array();
        for (const LevelSummary& level : levels)
            json["level"].push_back({{"nodes", level.nodes},
                                     {"points", level.points},
                                     {"points_to_here", level.points_to_here},
                                     {"spacing_min", level.finest},
                                     {"spacing_max", level.coarsest}});
        json["nodes"] = tree->nodes().size();
        json["bytes"] = info.bytes;
        json["sources"] = info.sources;
        std::printf("%s\n", json.dump(2).c_str());
        return 0;
    }
    std::printf("%s\n", tree->folder().string().c_str());
    std::printf("points      %s\n", grouped(info.points).c_str());
    if (info.points_skipped)
        std::printf("skipped     %s without a finite position\n", grouped(info.points_skipped).c_str());
    const auto print_vec = [](const char* name, const Vec3d& v) {
        std::printf("%-11s %s  %s  %s\n", name, exact(v[0]).c_str(), exact(v[1]).c_str(), exact(v[2]).c_str());
    };
    if (info.points) {
        print_vec("min", bounds.min);
        print_vec("max", bounds.max);
    }
    print_vec("scale", info.grid.scale);
    print_vec("origin", info.grid.offset);
    std::printf("positions   %s, largest error %s\n", std::string(name_of(info.position_type)).c_str(),
                exact(info.position_error).c_str());
    std::printf("attributes ");
    for (const Attribute& attribute : info.schema) {
        std::printf(" %s:%s", attribute.name.c_str(), std::string(name_of(attribute.type)).c_str());
        if (attribute.components > 1) std::printf("x%u", attribute.components);
    }
    std::printf("%s\n", info.schema.empty() ? " none" : "");
    std::printf("size        %s, %.2f bytes a point\n", bytes_text(info.bytes).c_str(),
                info.points ? static_cast<double>(info.bytes) / static_cast<double>(info.points) : 0.0);
    std::printf("level  nodes          points  points to here  spacing\n");
    for (std::size_t i = 0; i < levels.size(); ++i) {
        const LevelSummary& level = levels[i];
        std::printf("%5zu %6llu %15s %15s  ", i, static_cast<unsigned long long>(level.nodes),
                    grouped(level.points).c_str(), grouped(level.points_to_here).c_str());
        if (level.coarsest > 0)
            std::printf("%.4g to %.4g\n", level.finest, level.coarsest);
        else
            std::printf("full\n");
    }
    return 0;
}

}  // namespace

void add_info(CLI::App& app, int& result)
{
    auto arguments = std::make_shared<Arguments>();
    CLI::App* command = app.add_subcommand("info", "Say what a point cloud tree holds");
    command->add_option("tree", arguments->tree, "Tree folder, or the index file in it")->required();
    add_common(*command, arguments->common);
    command->callback([arguments, &result] { result = info(*arguments); });
}

}  // namespace pcm::cli
