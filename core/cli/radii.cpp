#include "pcm/cli/attribute_options.h"

#include <memory>

namespace pcm::cli {
namespace {

struct Arguments {
    Common common;
    std::string tree;
    TargetOptions target;
    NeighbourOptions neighbours;
    bool mean_distance = false;
};

int run(const Arguments& arguments)
{
    NeighbourAttributeOptions options;
    options.wanted.radius = true;
    options.wanted.mean_distance = arguments.mean_distance;
    arguments.neighbours.put_into(options);
    return run_attribute_filter(arguments.common, arguments.tree, arguments.target, options);
}

}  // namespace

Run add_radii(Options& options)
{
    auto arguments = std::make_shared<Arguments>();
    options.positional("tree", arguments->tree, "Tree folder, or any file of it").required();
    arguments->target.add_to(options);
    arguments->neighbours.neighbours = 6;
    arguments->neighbours.add_to(options);
    options.flag("--mean-distance", arguments->mean_distance,
                 "Also write the attribute mean_distance: to the neighbours, source units");
    add_common(options, arguments->common);
    return [arguments] { return run(*arguments); };
}

}  // namespace pcm::cli
