#include "pcm/cli/render/radii.h"

#include "pcm/cli/render.h"
#include "pcm/gl/compute/gpu_cursor.h"
#include "pcm/gl/compute/gpu_radii.h"
#include "pcm/offscreen/offscreen.h"
#include "pcm/ops/result.h"
#include "pcm/point_cloud.h"
#include "pcm/system/peak_memory.h"
#include "pcm/update/target.h"

#include <algorithm>
#include <cstdio>
#include <memory>

namespace pcm::cli {
namespace {

struct Arguments {
    Common common;
    GpuRadii radii;
    std::string output;
};

GpuRadiiReport compute(const Arguments& arguments, const std::filesystem::path& tree, bool& normals)
{
    L2Options l2;
    l2.capacity_bytes = arguments.radii.memory;
    L1Options l1;
    l1.capacity_bytes = std::max<std::uint64_t>(arguments.radii.video_memory, l1.block_bytes);
    const auto cloud = PointCloud::open(tree, l2, Access::write);
    const auto cache = std::make_shared<L1Cache>(l1);
    GpuRadiiOptions options;
    options.neighbours = arguments.radii.neighbours;
    options.progress = console_progress(arguments.common);
    const Schema& schema = cloud->info().schema;
    const auto place = schema.find(attribute_name::normal);
    options.normals = normals = place && schema[*place].components == 3;
    try {
        GpuRadiiReport report = compute_radii_on_gpu(cloud, cache, options);
        run_last_step(report.outcome, [&] { cloud->close(); });
        return report;
    } catch (...) {
        cloud->abandon();
        throw;
    }
}

int run(Arguments& arguments)
{
    const Offscreen context;
    require_compute_shaders();  // before a copy is made
    TargetChoice& choice = arguments.radii.target;
    choice.copy = arguments.output;
    UpdateTarget target(arguments.radii.tree, choice);
    bool normals = false;
    const GpuRadiiReport report =
        target.update([&](const std::filesystem::path& folder) { return compute(arguments, folder, normals); });
    end_progress(arguments.common);
    if (arguments.common.json) {
        ops::Result result;
        result.input = {arguments.radii.tree};
        result.output = target.path().string();
        result.outcome = report.outcome;
        result.values["level"] = nullptr;
        result.values["points_checked"] = 0;
        result.values["errors"] = ops::Json::array();
        result.values["points_computed"] = report.outcome.points_out;
        result.values["used_known_normals"] = normals;
        result.values["radii_limited"] = nullptr;
        result.values["confidence"] = nullptr;
        result.values["flipped"] = nullptr;
        result.values["computed_with"] = context.renderer();
        print_json(ops::json_of("radii", result));
        return finished(report.outcome);
    }
    std::printf("%s: radii: %.1f s, exact\n%s points, computed with %s, peak memory %s\n", target.path().c_str(),
                report.outcome.seconds, grouped(report.outcome.points_out).c_str(), context.renderer().c_str(),
                bytes_text(peak_memory_bytes()).c_str());
    if (normals) std::printf("radii were measured across the normals that the tree has\n");
    return finished(report.outcome);
}

}  // namespace

Run add_gpu_radii(Options& options)
{
    auto arguments = std::make_shared<Arguments>();
    options.positional("tree", arguments->radii.tree, "Tree folder, or any file of it").required();
    options.option("-o,--output", arguments->output, "Tree folder to write");
    options.flag("--in-place", arguments->radii.target.in_place, "Change the tree itself");
    options.flag("--overwrite", arguments->radii.target.overwrite, "Replace an existing tree of the output's name");
    options.option("-k,--neighbours", arguments->radii.neighbours, "Number of nearest neighbours (default 16)")
        .between(1, static_cast<int>(GpuRadiiOptions::most_neighbours));
    options.option("-m,--memory", arguments->radii.memory, "Cache for chunks (default 512M)").bytes();
    options
        .option("--video-memory", arguments->radii.video_memory,
                "Cache for chunks in video memory (default 512M; some 40 MB more are used)")
        .bytes();
    add_common(options, arguments->common);
    return [arguments] { return run(*arguments); };
}

}  // namespace pcm::cli
