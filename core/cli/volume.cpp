#include "pcm/measure/volume.h"

#include "pcm/cli/measure_output.h"
#include "pcm/cli/region_options.h"
#include "pcm/system/error.h"

#include <cstdio>
#include <memory>
#include <utility>

namespace pcm::cli {
namespace {

struct Arguments {
    Common common;
    MeasureFiles files;
    std::string tree, before, height = "mean", name;
    std::vector<double> polygon, plane;
    std::optional<double> reference;
    RegionOptions limits;
    bool interpolate = false, measured_only = false;
    VolumeOptions options;
};

void set_reference(Arguments& arguments)
{
    const int given =
        int(arguments.reference.has_value()) + int(!arguments.plane.empty()) + int(!arguments.before.empty());
    if (given != 1) throw UsageError("what to compare with: give one of --reference, --plane and --before");
    const std::vector<double>& n = arguments.plane;
    if (arguments.reference)
        arguments.options.reference.height = *arguments.reference;
    else if (!n.empty())
        arguments.options.reference = plane_of({n[0], n[1], n[2]}, {n[3], n[4], n[5]});
    else
        arguments.options.before = PointCloud::open(arguments.before);
}

Measure measure_of(const Arguments& arguments, const VolumeReport& report, const PointCloud& cloud)
{
    Measure measure;
    measure.kind = MeasureKind::volume;
    measure.name = arguments.name;
    measure.computed = report.values();
    std::vector<Vec3d> polygon = arguments.options.polygon;
    if (polygon.empty()) polygon = plan_rectangle(cloud.info().bounds());
    for (const Vec3d& p : polygon) measure.points.push_back({p, 0, 0, arguments.tree});
    return measure;
}

Json json_of(const Arguments& arguments, const VolumeReport& report, const std::string& unit)
{
    Json json;
    json["tree"] = arguments.tree;
    if (!arguments.before.empty()) json["before"] = arguments.before;
    put_outcome(json, report.outcome);
    for (const MeasureValue& value : report.values()) {
        if (value.unit != "^3") continue;
        json[value.name] = value.value;
        json[value.name + "_uncertainty"] = value.uncertainty;
    }
    json["spread"] = {{"net", report.net_spread}, {"cut", report.cut_spread}, {"fill", report.fill_spread}};
    json["coarser"] = {{"cut", report.cut_coarse}, {"fill", report.fill_coarse}, {"side", 2 * report.side}};
    json["gaps"] = {{"net", report.net_gaps}, {"cut", report.cut_gaps}, {"fill", report.fill_gaps}};
    json["excess"] = report.excess;
    json["side"] = report.side;
    json["usual_side"] = report.usual_side;
    json["cells"] = report.cells;
    json["cells_without_data"] = report.cells_without_data;
    json["area"] = report.area;
    json["covered"] = report.covered();
    json["area_counted"] = report.area_counted;
    json["area_without_data"] = report.area_without_data;
    json["area_interpolated"] = report.area_interpolated;
    json["area_extrapolated"] = report.area_extrapolated;
    json["notes"] = report.notes();
    json["points_of_tree"] = report.points[0];
    if (!arguments.before.empty()) json["points_before"] = report.points[1];
    json["unit"] = unit;
    json["files"] = arguments.files.outputs;
    return json;
}

// What the volume is known of.
std::string headline(const VolumeReport& report)
{
    const double percent = 100 * report.covered();
    if (percent >= 99.95) return "all of the area has points";
    char text[32];
    std::snprintf(text, sizeof text, percent < 1 ? "%.1f" : "%.0f", percent);
    return std::string(text) + " % of the area has points" +
           (report.area_interpolated > 0 ? ", the rest is interpolated" : ", the rest is left out");
}

void print(const Arguments& arguments, const VolumeReport& report, const std::string& unit)
{
    for (const MeasureValue& value : report.values()) {
        if (value.unit != "^3") continue;
        std::printf("%-11s %s", value.name.c_str(), text_of(value, unit).c_str());
        std::printf("%s\n", value.name == "net" ? (", " + headline(report)).c_str() : "");
    }
    std::printf("cells       %s of %s wide; %s points\n", grouped(report.cells).c_str(), brief(report.side).c_str(),
                grouped(report.outcome.points_out).c_str());
    std::printf("area        %s in plan, %s of it without points", brief(report.area).c_str(),
                brief(report.area_without_data).c_str());
    if (report.area_interpolated > 0)
        std::printf(": interpolated%s", report.area_extrapolated > 0
                                            ? (", " + brief(report.area_extrapolated) + " extrapolated").c_str()
                                            : "");
    else if (report.area_without_data > 0)
        std::printf(": left out");
    std::printf("\nuncertainty spread in cells %s; interpolation %s; cells twice as wide change the net volume by %s\n",
                brief(report.net_spread).c_str(), brief(report.net_gaps).c_str(),
                brief(report.cut_coarse - report.fill_coarse - (report.cut_measured - report.fill_measured)).c_str());
    for (const std::string& note : report.notes()) std::printf("note: %s\n", note.c_str());
    for (const std::string& output : arguments.files.outputs) std::printf("%s written\n", output.c_str());
}

int run(Arguments& arguments)
{
    arguments.files.check();
    set_reference(arguments);
    const auto cloud = PointCloud::open(arguments.tree);
    VolumeOptions& options = arguments.options;
    check_level(*cloud, options.level);
    if (!arguments.polygon.empty())
        options.polygon =
            plan_points_of(arguments.polygon, "--polygon", cloud->info().points ? cloud->info().bounds().min[2] : 0);
    options.height = arguments.height == "mean"     ? CellHeight::mean
                     : arguments.height == "lowest" ? CellHeight::lowest
                                                    : CellHeight::highest;
    if (arguments.measured_only && arguments.interpolate)
        throw UsageError("--interpolate and --measured-only contradict each other");
    if (arguments.measured_only) options.empty = EmptyCells::left_out;
    Selection limits = arguments.limits.get();
    options.where = std::move(limits.where);
    options.clips = std::move(limits.clips);
    options.progress = console_progress(arguments.common);
    const VolumeReport report = measure_volume(*cloud, options);
    end_progress(arguments.common);
    const auto system = system_of(*cloud);
    if (const std::string caution = caution_of(system); !caution.empty() && !arguments.common.json)
        std::printf("note: %s\n", caution.c_str());
    MeasureList list;
    list.add(measure_of(arguments, report, *cloud));
    arguments.files.write(list, system);
    if (arguments.common.json)
        print_json(json_of(arguments, report, length_unit_of(system)));
    else
        print(arguments, report, length_unit_of(system));
    return 0;
}

}  // namespace

Run add_volume(Options& options)
{
    auto arguments = std::make_shared<Arguments>();
    options.positional("tree", arguments->tree, "The tree, whose points are the surface").required();
    options
        .option("--polygon", arguments->polygon,
                "Corners in plan, x0 y0 x1 y1 x2 y2 ..., source coordinates: --polygon 0 0 9 0 9 9 (default: the "
                "tree's box)")
        .values(6, 1 << 20);
    options.option("--reference", arguments->reference,
                   "Height that the surface is compared with, source units: --reference 98.5");
    options
        .option("--plane", arguments->plane,
                "Plane to compare with: a point x y z and a normal nx ny nz: --plane 0 0 98 0 0.1 1")
        .values(6);
    options.option("--before", arguments->before, "Tree whose surface is compared with: what was there before");
    options
        .option("-s,--side", arguments->options.side,
                "Side of the square cells, source units (default: so that cells that have points have about 9)")
        .positive();
    options.option("--height", arguments->height, "Height of a cell: of its points the mean, lowest or highest")
        .one_of({"mean", "lowest", "highest"})
        .show_default();
    options.flag("--interpolate", arguments->interpolate,
                 "Give cells without points heights from those around them, and the uncertainty what that may be wrong "
                 "by (the default)");
    options.flag("--measured-only", arguments->measured_only,
                 "Leave cells without points out: the volume of the part of the polygon that has points");
    options.option("-l,--level", arguments->options.level, "Only the clouds at this level (default: all points)");
    arguments->limits.add_limits_to(options, "Which points");
    options.option("-m,--memory", arguments->options.memory, "Memory for the cells, e.g. 2G (default 512M)").bytes();
    options.option("--name", arguments->name, "Name of the measure in files (default: Volume 1)");
    arguments->files.add_to(options);
    add_common(options, arguments->common);
    return [arguments] { return run(*arguments); };
}

}  // namespace pcm::cli
