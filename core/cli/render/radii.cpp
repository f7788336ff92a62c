#include "pcm/cli/render/radii.h"

#include "pcm/gl/compute/gpu_cursor.h"
#include "pcm/gl/compute/gpu_radii.h"
#include "pcm/offscreen/offscreen.h"
#include "pcm/point_cloud.h"
#include "pcm/system/peak_memory.h"
#include "pcm/system/text.h"
#include "pcm/update/target.h"

#include <memory>

namespace pcm::cli {
namespace {

GpuRadiiReport compute(const ops::GpuRadiiRequest& request, const ProgressFunction& progress,
                       const std::filesystem::path& tree, bool& normals)
{
    L2Options l2;
    l2.capacity_bytes = request.memory_bytes;
    const auto cloud = PointCloud::open(tree, l2, Access::write);
    const auto cache = std::make_shared<L1Cache>(L1Options());
    GpuRadiiOptions options;
    options.neighbours = request.neighbours;
    options.progress = progress;
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

}  // namespace

ops::Result radii_on_gpu(const ops::GpuRadiiRequest& request, const ProgressFunction& progress)
{
    const Offscreen context;
    require_compute_shaders();  // before a copy is made
    UpdateTarget target(request.tree, request.target);
    bool normals = false;
    const GpuRadiiReport report =
        target.update([&](const std::filesystem::path& folder) { return compute(request, progress, folder, normals); });
    ops::Result result;
    result.input = {request.tree};
    result.output = target.path().string();
    result.outcome = report.outcome;
    result.accuracy = ops::exact_answer();
    result.values["used_known_normals"] = normals;
    result.values["radii_limited"] = nullptr;
    result.values["confidence"] = nullptr;
    result.values["flipped"] = nullptr;
    result.values["computed_with"] = context.renderer();
    result.print("%s: radii: %.1f s, exact", target.path().c_str(), report.outcome.seconds);
    result.line(grouped(report.outcome.points_out) + " points, computed with " + context.renderer());
    if (normals) result.line("radii were measured across the normals that the tree has");
    return result;
}

}  // namespace pcm::cli
