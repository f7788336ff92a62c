#include "pcm/cli/attribute_options.h"
#include "pcm/cli/render.h"

#include <memory>

namespace pcm::cli {
namespace {

struct Arguments {
    Common common;
    std::string tree;
    TargetOptions target;
    NeighbourOptions neighbours;
    bool mean_distance = false;
    std::string device = "cpu";
};

[[noreturn]] void run_on_gpu(const Arguments& arguments)
{
    const NeighbourOptions& asked = arguments.neighbours;
    if (arguments.mean_distance || asked.max_distance || asked.level || asked.time_limit || asked.error_target ||
        asked.threads > 0 || asked.flann)
        throw UsageError(
            "--device gpu computes exact radii and nothing else: of the options that choose what is "
            "computed and how, it takes --neighbours and --memory");
    GpuRadii radii;
    radii.tree = arguments.tree;
    radii.target = arguments.target.get();
    radii.neighbours = asked.neighbours;
    radii.memory = asked.memory;
    radii.json = arguments.common.json;
    radii.quiet = arguments.common.quiet;
    start_gpu_radii(radii);
}

int run(const Arguments& arguments)
{
    if (arguments.device == "gpu") run_on_gpu(arguments);
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
    arguments->target.add_overwrite(options, "mean_distance");
    arguments->neighbours.neighbours = usual_radius_neighbours;
    arguments->neighbours.add_to(options);
    options.flag("--mean-distance", arguments->mean_distance,
                 "Also write the attribute mean_distance: to the neighbours, source units");
    options
        .option(
            "--device", arguments->device,
            "cpu, or gpu: by compute shaders, which takes OpenGL 4.3 and pcmlab-render; worth it on a graphics card "
            "alone")
        .one_of({"cpu", "gpu"})
        .show_default();
    add_common(options, arguments->common);
    return [arguments] { return run(*arguments); };
}

}  // namespace pcm::cli
