// Cross-Section Profile: the points of a tree along a line.
#include "pcm/measure/profile.h"

#include "pcm/system/error.h"
#include "plugin/filter/filter.h"
#include "plugin/filter/measure_parameters.h"
#include "plugin/filter/parameters.h"
#include "plugin/filter/result_parameters.h"
#include "plugin/panels/operation.h"
#include "plugin/scene/text.h"

#include <limits>

namespace pcm::host {

namespace {

void add_parameters(RichParameterList& parameters)
{
    add_tree_parameter(parameters);
    parameters.addParam(RichString("Line", "", "Line",
                                   "The line of the profile, seen from above: x y of two or more points, in source "
                                   "coordinates and units, separated by blanks. There is no default."));
    parameters.addParam(RichFloat("Width", 1, "Width",
                                  "Width of the profile, in source units: points up to half of it on either side of "
                                  "the line belong to it. Default 1."));
    parameters.addParam(RichString("Heights", "", "Heights",
                                   "Only points whose height lies between these two numbers, lowest and highest, in "
                                   "source units. Empty, the default: all heights."));
    add_part_parameters(parameters);
    parameters.addParam(RichString("Attributes", "", "Attributes",
                                   "Attributes to write to CSV beside station, offset, x, y and z, separated by "
                                   "commas. Empty, the default: none."));
    parameters.addParam(RichBool("InPlace", false, "Drawing in place",
                                 "DXF has the points at their source coordinates. Default off: at station and height, "
                                 "a drawing of the profile."));
    parameters.addParam(RichFloat("Exaggeration", 1, "Exaggeration",
                                  "Factor of heights in a DXF drawing that is not in place; no unit. Default 1."));
    add_output_file_parameters(parameters, ".csv or .dxf, as its name ends");
}

struct Extent {
    Box3d box;  // station, offset, z
    void log(const FilterRun& run) const
    {
        if (box.empty()) return;
        run.log("Stations from " + exact(box.min[0]) + " to " + exact(box.max[0]) + ", offsets from " +
                exact(box.min[1]) + " to " + exact(box.max[1]) + ", heights from " + exact(box.min[2]) + " to " +
                exact(box.max[2]) + " source units");
    }
};

ProfileOptions options_of(const FilterRun& run, const PointCloud& cloud)
{
    ProfileOptions options;
    options.line =
        points_parameter(run.parameters, "Line", "Line", 2, cloud.info().points ? cloud.info().bounds().min[2] : 0);
    options.width = decimal_of(run.parameters, "Width");
    if (const auto heights = numbers_of(run.parameters, "Heights", "Heights", 2)) {
        options.lowest = (*heights)[0];
        options.highest = (*heights)[1];
    }
    options.level = level_of(run.parameters, cloud);
    options.where = where_of(run.parameters);
    options.attributes = names_of(run.parameters, "Attributes");
    return options;
}

void run(const FilterRun& run)
{
    const auto cloud = PointCloud::open(tree_of(run.parameters, run.document));
    ProfileOptions options = options_of(run, *cloud);
    ProfileFileOptions file_options;
    file_options.overwrite = overwrite_of(run.parameters);
    file_options.in_place = run.parameters.getBool("InPlace");
    file_options.exaggeration = decimal_of(run.parameters, "Exaggeration");
    const std::filesystem::path output = output_file_of(run.parameters);
    Operation operation(run.callback);
    options.progress = operation.progress();
    Extent extent;
    const auto visit = [&](const ProfilePoint& point, const PointView&, std::size_t) {
        extent.box.extend(Vec3d{point.station, point.offset, point.position[2]});
    };
    const Outcome outcome =
        output.empty() ? visit_profile(*cloud, options, visit) : write_profile(*cloud, options, output, file_options);
    log_warnings(run, outcome.warnings);
    run.log("Profile of " + cloud->tree()->folder().string() + ", " + exact(ProfileLine(options.line).length()) +
            " source units long: " + grouped(outcome.points_out) + " points in " + brief(outcome.seconds) + " s");
    extent.log(run);
    if (outcome.error > 0)
        run.log("Level " + std::to_string(*options.level) + " only: every point of the cloud is nearer than " +
                brief(outcome.error) + " source units to a point of it");
    if (!output.empty()) run.log(output.string() + " written");
}

}  // namespace

Filter profile_filter()
{
    return {"Cross-Section Profile",
            "Finds the points of a <b>point cloud tree</b> along a line seen from above, within a width: for each its "
            "station along the line, its offset across and its height. Writes them to CSV, or to DXF as a drawing of "
            "heights over stations. It takes clouds of any size in bounded memory. Esc cancels it.",
            MeshFilterInterface::Measure, add_parameters, run};
}

}  // namespace pcm::host
