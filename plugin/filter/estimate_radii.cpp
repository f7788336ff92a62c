// Estimate Radii of Point Cloud Tree: how large the splats of points are, from their nearest neighbours.
#include "plugin/filter/filter.h"
#include "plugin/filter/neighbour_parameters.h"
#include "plugin/filter/parameters.h"
#include "plugin/filter/tree_target.h"

namespace pcm::host {

namespace {

void add_parameters(RichParameterList& parameters)
{
    add_tree_parameter(parameters);
    add_neighbours_parameter(parameters, int(usual_radius_neighbours), "whose distances a radius covers");
    add_precision_parameters(parameters);
    add_target_parameters(parameters);
    add_work_parameters(parameters);
}

void run(const FilterRun& run)
{
    NeighbourAttributeOptions options;
    options.wanted.radius = true;
    options.neighbours = neighbours_of(run.parameters);
    read_precision(run.parameters, options);
    run_attribute_filter(run, options);
}

}  // namespace

Filter estimate_radii()
{
    using F = MeshFilterInterface;
    return {"Estimate Radii of Point Cloud Tree",
            "Gives every point of a <b>point cloud tree</b> the radius of its splat: the largest distance to its "
            "nearest neighbours, measured across the point's normal where the cloud has normals. The result is the "
            "attribute <i>radius</i>, in a copy of the tree or in place. Works on clouds larger than memory. Esc "
            "cancels it.",
            F::FilterClass(F::MeshCreation | F::PointSet),
            add_parameters,
            run,
            "-radii.pct"};
}

}  // namespace pcm::host
