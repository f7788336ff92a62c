// Estimate Normals of Point Cloud Tree: from the nearest neighbours of each point; radii in the same pass.
#include "pcm/system/error.h"
#include "plugin/filter/filter.h"
#include "plugin/filter/neighbour_parameters.h"
#include "plugin/filter/parameters.h"
#include "plugin/filter/tree_target.h"

namespace pcm::host {

namespace {

void add_parameters(RichParameterList& parameters)
{
    add_tree_parameter(parameters);
    add_neighbours_parameter(parameters, 16, "to which a plane is fitted");
    parameters.addParam(RichBool("Radii", true, "Radii too",
                                 "Also compute the radii of the splats, across the normals, in the same pass. Default "
                                 "on."));
    parameters.addParam(
        RichInt("RadiusNeighbours", int(usual_radius_neighbours), "Neighbours of a radius",
                QString("How many of the nearest neighbours a radius covers, from 1 to Neighbours. More "
                        "make larger discs, fewer leave gaps. Default %1.")
                    .arg(usual_radius_neighbours)));
    parameters.addParam(RichFloat(
        "RadiusLimit", float(usual_radius_limit), "Limit of radii",
        QString("A radius is at most so many times the size of the point that the tree has for splats, so that "
                "the discs of points that stand alone stay small. 0: no limit. Default %1.")
            .arg(usual_radius_limit)));
    parameters.addParam(RichBool("Curvature", false, "Curvature too",
                                 "Also write the attribute curvature: the share of the smallest of the three variances "
                                 "of the neighbours, from 0 (a plane) to 1/3. Default off."));
    parameters.addParam(
        RichBool("Confidence", true, "Confidence too",
                 "Also write the attribute normal_confidence: 0 good, 1 the neighbours are on a line, 2 "
                 "they are as thick as wide, 3 there are too few. Default on."));
    parameters.addParam(RichString("Viewpoint", "", "Scanner position",
                                   "Normals point towards this place, where the scanner stood: x y z, three numbers "
                                   "separated by blanks, in source coordinates and units. Empty, the default: not "
                                   "known."));
    parameters.addParam(
        RichString("Direction", "", "Direction",
                   "Without a scanner position: normals point to the half space of this direction, x y "
                   "z, three numbers separated by blanks, such as 0 0 1. Empty, the default: neighbours agree "
                   "along each surface, which points outward or up."));
    add_precision_parameters(parameters);
    add_target_parameters(parameters);
    add_work_parameters(parameters);
}

void run(const FilterRun& run)
{
    const RichParameterList& parameters = run.parameters;
    NeighbourAttributeOptions options;
    options.wanted.normal = true;
    options.wanted.radius = parameters.getBool("Radii");
    options.wanted.curvature = parameters.getBool("Curvature");
    options.wanted.confidence = parameters.getBool("Confidence");
    options.neighbours = neighbours_of(parameters);
    options.radius_limit = parameters.getFloat("RadiusLimit");
    if (options.wanted.radius)
        options.wanted.radius_neighbours = static_cast<std::size_t>(in_range(
            parameters, "RadiusNeighbours", "Neighbours of a radius", 1, static_cast<int>(options.neighbours)));
    const auto viewpoint = three_numbers_of(parameters, "Viewpoint", "Scanner position");
    const auto direction = three_numbers_of(parameters, "Direction", "Direction");
    if (viewpoint && direction)
        throw Error(ErrorCode::invalid_argument, {}, "a scanner position and a direction are given",
                    "leave one of them empty");
    if (viewpoint) options.orientation = {NormalOrientation::Rule::viewpoint, *viewpoint};
    if (direction) options.orientation = {NormalOrientation::Rule::direction, *direction};
    read_precision(parameters, options);
    run_attribute_filter(run, options);
}

}  // namespace

Filter estimate_normals()
{
    using F = MeshFilterInterface;
    return {"Estimate Normals of Point Cloud Tree",
            "Gives every point of a <b>point cloud tree</b> the normal of the plane through its nearest neighbours "
            "and, in the same pass, the radius of its splat. The results are the attributes <i>normal</i> and "
            "<i>radius</i>, in a copy of the tree or in place, and Fitted splats follow them. Works on "
            "clouds "
            "larger than memory. Esc cancels it.",
            F::FilterClass(F::MeshCreation | F::PointSet),
            add_parameters,
            run,
            "-normals.pct"};
}

}  // namespace pcm::host
