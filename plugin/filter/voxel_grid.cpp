// Voxel Grid of Point Cloud Tree: one point for each voxel.
#include "pcm/filter/voxel_grid.h"

#include "plugin/filter/filter.h"
#include "plugin/filter/parameters.h"
#include "plugin/filter/result_parameters.h"
#include "plugin/filter/tree_target.h"
#include "plugin/panels/operation.h"
#include "plugin/scene/text.h"

namespace pcm::host {

namespace {

void add_parameters(RichParameterList& parameters)
{
    add_tree_parameter(parameters);
    parameters.addParam(
        RichFloat("VoxelSize", 0.1f, "Voxel size", "Length of a voxel's edge, in source units. Default 0.1."));
    parameters.addParam(RichString("Anchor", "", "Anchor",
                                   "Source coordinates x y z of a corner of voxels, separated by blanks. Empty, the "
                                   "default: 0 0 0, so that grids of different clouds fit together."));
    parameters.addParam(RichEnum("Point", 0, {"Centroid", "Nearest point"}, "Point of a voxel",
                                 "Centroid, the default: the mean position with the means of the attributes; of "
                                 "classes, flags and identities the most frequent value. Nearest point: the point "
                                 "that is nearest to the centroid, unchanged."));
    parameters.addParam(RichBool("Count", false, "Add point_count",
                                 "Add an attribute point_count: the number of points in the voxel. Default off."));
    parameters.addParam(RichString("Majority", "", "By majority",
                                   "Integer attributes of which the most frequent value is taken, separated by "
                                   "commas. Empty, the default: classification, return numbers, flags, identities."));
    parameters.addParam(RichString("Mean", "", "By mean",
                                   "Attributes of which the mean is taken, separated by commas. Empty, the default: "
                                   "all but those above."));
    add_result_parameters(parameters, true);
}

void run(const FilterRun& run)
{
    const std::filesystem::path tree = tree_of(run.parameters, run.document);
    ResultOptions result = result_options_of(run.parameters);
    VoxelGridOptions options;
    options.voxels.size = decimal_of(run.parameters, "VoxelSize");
    if (const auto anchor = numbers_of(run.parameters, "Anchor", "Anchor", 3))
        options.voxels.anchor = {(*anchor)[0], (*anchor)[1], (*anchor)[2]};
    options.point = run.parameters.getEnum("Point") == 1 ? VoxelPoint::nearest : VoxelPoint::centroid;
    options.count = run.parameters.getBool("Count");
    options.by_majority = names_of(run.parameters, "Majority");
    options.by_mean = names_of(run.parameters, "Mean");
    Operation operation(run.callback);
    result.progress = operation.progress();
    const VoxelGridReport report = voxel_grid(tree, options, result);
    log_result(run, "Voxel grid of " + exact(options.voxels.size) + " source units, of " + tree.string(), report.build);
    run.log("At most " + grouped(report.most_in_one) + " points in a voxel.");
    show_result(run, tree, result.target);
}

}  // namespace

Filter voxel_grid_filter()
{
    using F = MeshFilterInterface;
    return {"Voxel Grid of Point Cloud Tree",
            "Makes a <b>point cloud tree</b> with one point for each voxel that has points: their centroid, with the "
            "means of their colours, normals and other attributes, or the point nearest to it. The voxels' corners "
            "are multiples of their size in source coordinates. It takes clouds of any size in bounded memory. Esc "
            "cancels it.",
            F::FilterClass(F::MeshCreation | F::PointSet | F::Sampling),
            add_parameters,
            run,
            "-voxels.pct"};
}

}  // namespace pcm::host
