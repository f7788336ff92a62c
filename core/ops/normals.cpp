// The normal of every point from its nearest neighbours, and radii in the same pass.
#include "pcm/ops/shared/attribute_report.h"
#include "pcm/ops/shared/neighbour_arguments.h"
#include "pcm/ops/table.h"

namespace pcm::ops {
namespace {

class Normals : public Operation {
public:
    Normals()
    {
        target_.declare_cloud(arguments_);
        WantedValues& wanted = options_.wanted;
        wanted.normal = true;
        wanted.radius_neighbours = usual_radius_neighbours;
        options_.radius_limit = usual_radius_limit;
        arguments_.add("radii", wanted.radius)
            .label("Radii too")
            .help("Also write the radii of splats, measured across the normals, in the same pass")
            .on_in_dialogs();
        declare_radii(wanted);
        arguments_.add("curvature", wanted.curvature)
            .label("Curvature too")
            .help(
                "Also write the attribute curvature: the share of the smallest of the three variances of the "
                "neighbours, from 0 (a plane) to 1/3");
        arguments_.add("mean_distance", wanted.mean_distance)
            .label("Mean distance too")
            .help("Also write the attribute mean_distance: to the neighbours, in source units");
        wanted.confidence = true;
        arguments_.add("confidence", wanted.confidence)
            .label("Confidence too")
            .help(
                "the attribute normal_confidence: 0 good, 1 neighbours on a line, 2 no plane, 3 too few neighbours, 4 "
                "on two surfaces, as of a thin plate: the side is a guess");
        declare_sides();
        target_.declare_target(arguments_, "normal_confidence, curvature and mean_distance");
        neighbours_.declare(arguments_, "to which a plane is fitted");
    }

    Result answer(const Context& context) override
    {
        if (int(!viewpoint_.empty()) + int(!direction_.empty()) + int(scanners_) > 1)
            throw ArgumentError(called(context, "viewpoint") + ", " + called(context, "direction") + " and " +
                                called(context, "scanners") + " exclude each other: leave all but one of them out");
        if (scanners_) options_.orientation.rule = NormalOrientation::Rule::scanners;
        if (!viewpoint_.empty())
            options_.orientation = {NormalOrientation::Rule::viewpoint, {viewpoint_[0], viewpoint_[1], viewpoint_[2]}};
        if (!direction_.empty())
            options_.orientation = {NormalOrientation::Rule::direction, {direction_[0], direction_[1], direction_[2]}};
        neighbours_.put_into(options_, called(context, "memory"));
        return compute_attributes(context, target_, arguments_, options_);
    }

private:
    void declare_radii(WantedValues& wanted)
    {
        arguments_.add("radius_neighbours", wanted.radius_neighbours)
            .between(1, most_neighbours)
            .label("Neighbours of a radius")
            .help(
                "How many of the nearest neighbours a radius covers, at most all of them; more make larger discs, "
                "fewer "
                "leave gaps")
            .advanced();
        arguments_.add("radius_limit", options_.radius_limit)
            .not_negative()
            .label("Limit of radii")
            .help(
                "A radius is at most this many times the size of the point that the tree has for splats, so that discs "
                "of isolated points stay small; 0: no limit")
            .advanced();
    }

    void declare_sides()
    {
        const char* const group = "Side that normals point to (default: the same along each surface, outward or up)";
        arguments_.add("viewpoint", viewpoint_)
            .count(3)
            .group(group)
            .label("Scanner position")
            .without("not known")
            .help("Normals point towards the scanner's position X Y Z, source coordinates");
        arguments_.add("scanners", scanners_)
            .group(group)
            .label("Scanners of the scans")
            .help(
                "Normals point towards where each point's scanner stood, as the poses of PTX and E57 files and the "
                "attribute scan say");
        arguments_.add("direction", direction_)
            .count(3)
            .group(group)
            .label("Direction")
            .without("none")
            .help("Normals point to the half space of a direction X Y Z, such as 0 0 1");
    }

    TargetArguments target_;
    NeighbourArguments neighbours_;
    NeighbourAttributeOptions options_;
    std::vector<double> viewpoint_, direction_;
    bool scanners_ = false;
};

}  // namespace

Row normals_row()
{
    return {
        "normals",
        "Estimate Normals of Point Cloud Tree",
        "Compute the normal of every point from its nearest neighbours, and radii in the same pass",
        "Gives every point of a <b>point cloud tree</b> the normal of the plane through its nearest neighbours and, "
        "in the same pass, the radius of its splat. The results are the attributes <i>normal</i> and <i>radius</i>, "
        "in a copy of the tree or in place, and Fitted splats follow them. Works on clouds larger than memory.",
        menu::points | menu::normals,
        "-normals.pct",
        attribute_keys(),
        make<Normals>,
        {"neighbours"},
        always_exact};
}

}  // namespace pcm::ops
