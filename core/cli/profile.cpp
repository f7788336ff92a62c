#include "pcm/measure/profile.h"

#include "pcm/cad/dxf_file.h"
#include "pcm/cli/measure_output.h"
#include "pcm/cli/region_options.h"
#include "pcm/system/error.h"

#include <cmath>
#include <cstdio>
#include <memory>
#include <utility>

namespace pcm::cli {
namespace {

struct Arguments {
    Common common;
    std::string tree, output;
    std::vector<double> line, heights;
    RegionOptions limits;
    ProfileOptions options;
    ProfileFileOptions file;
};

struct Extent {
    Box3d box;  // station, offset, z
    void add(const ProfilePoint& point) { box.extend(Vec3d{point.station, point.offset, point.position[2]}); }
};

void print(const Arguments& arguments, const Outcome& outcome, double length, const Extent& extent)
{
    std::printf("%s points of the profile, which is %s long, in %s\n", grouped(outcome.points_out).c_str(),
                exact(length).c_str(), time_text(outcome.seconds).c_str());
    if (!extent.box.empty())
        std::printf("station     %s to %s\noffset      %s to %s\nheight      %s to %s\n",
                    exact(extent.box.min[0]).c_str(), exact(extent.box.max[0]).c_str(),
                    exact(extent.box.min[1]).c_str(), exact(extent.box.max[1]).c_str(),
                    exact(extent.box.min[2]).c_str(), exact(extent.box.max[2]).c_str());
    if (outcome.error > 0)
        std::printf("level %u only: every point of the cloud is nearer than %s to a point of this level\n",
                    *arguments.options.level, brief(outcome.error).c_str());
    if (!arguments.output.empty()) std::printf("%s written\n", arguments.output.c_str());
}

int run(Arguments& arguments)
{
    const auto cloud = PointCloud::open(arguments.tree);
    ProfileOptions& options = arguments.options;
    check_level(*cloud, options.level);
    options.line = plan_points_of(arguments.line, "--line", cloud->info().points ? cloud->info().bounds().min[2] : 0);
    if (!arguments.heights.empty()) {
        options.lowest = arguments.heights[0];
        options.highest = arguments.heights[1];
    }
    Selection limits = arguments.limits.get();
    options.where = std::move(limits.where);
    options.clips = std::move(limits.clips);
    options.progress = console_progress(arguments.common);
    const double length = ProfileLine(options.line).length();
    Extent extent;
    const Outcome outcome =
        arguments.output.empty()
            ? visit_profile(*cloud, options,
                            [&](const ProfilePoint& p, const PointView&, std::size_t) { extent.add(p); })
            : write_profile(*cloud, options, arguments.output, arguments.file);
    end_progress(arguments.common);
    if (!arguments.common.json) {
        print(arguments, outcome, length, extent);
        return finished(outcome);
    }
    Json json;
    json["tree"] = arguments.tree;
    put_outcome(json, outcome);
    json["points_read"] = outcome.points_in;
    json["length"] = length;
    json["spacing"] = std::isfinite(outcome.error) ? Json(outcome.error) : Json();
    if (!extent.box.empty()) {
        json["stations"] = {extent.box.min[0], extent.box.max[0]};
        json["offsets"] = {extent.box.min[1], extent.box.max[1]};
        json["heights"] = {extent.box.min[2], extent.box.max[2]};
    }
    if (!arguments.output.empty()) json["file"] = arguments.output;
    print_json(json);
    return finished(outcome);
}

}  // namespace

Run add_profile(Options& options)
{
    auto arguments = std::make_shared<Arguments>();
    options.positional("tree", arguments->tree, "The tree").required();
    options
        .option("--line", arguments->line,
                "Points of the line in plan, x0 y0 x1 y1 ..., source coordinates: --line 0 0 25 10")
        .values(4, 1 << 20)
        .required();
    options
        .option("-w,--width", arguments->options.width,
                "Width of the profile, source units: points up to half of it on either side of the line")
        .required();
    options
        .option("--heights", arguments->heights, "Only points with z from LOW to HIGH, both included: --heights 98 105")
        .values(2);
    options.option("-l,--level", arguments->options.level, "Only the cloud at this level (default: all points)");
    arguments->limits.add_limits_to(options, "Which points");
    options
        .option("-a,--attribute", arguments->options.attributes,
                "Attribute to write to CSV beside station, offset, x, y and z; may be given several times")
        .one_value_each();
    options.option("-o,--output", arguments->output,
                   writes_dxf() ? "File to write the points to: .csv, or .dxf, a drawing of heights over stations"
                                : "File to write the points to: .csv");
    options.flag("--in-place", arguments->file.in_place, "Drawings: points at their source coordinates");
    options
        .option("--exaggeration", arguments->file.exaggeration, "Factor of heights in drawings that are not in place")
        .show_default();
    options.flag("--overwrite", arguments->file.overwrite, "Replace an existing output file");
    add_common(options, arguments->common);
    return [arguments] { return run(*arguments); };
}

}  // namespace pcm::cli
