#include "pcm/measure/measure.h"

#include "pcm/cli/measure_output.h"
#include "pcm/measure/snap.h"
#include "pcm/system/error.h"
#include "pcm/system/new_output.h"
#include "pcm/system/update_file.h"

#include <algorithm>
#include <cstdio>
#include <memory>

namespace pcm::cli {
namespace {

struct Arguments {
    Common common;
    MeasureFiles files;
    std::string kind, name, list, surface, from;
    std::vector<double> points;
};

// What takes a pass over clouds has commands of its own.
bool is_computed(MeasureKind kind) { return kind == MeasureKind::volume || kind == MeasureKind::profile; }

std::vector<std::string> kinds()
{
    std::vector<std::string> names;
    for (std::size_t k = 0; k < measure_kinds; ++k)
        if (!is_computed(static_cast<MeasureKind>(k))) names.push_back(name_of(static_cast<MeasureKind>(k)));
    return names;
}

Measure measure_of(const Arguments& arguments, PointCloud* cloud, double& moved)
{
    Measure measure;
    measure.kind = *measure_kind(arguments.kind);
    measure.name = arguments.name;
    if (!arguments.surface.empty()) {
        if (measure.kind != MeasureKind::surface) throw UsageError("--surface goes with the kind surface");
        measure.surface = parse_shape(arguments.surface);
    }
    for (const Vec3d& place : points_of(arguments.points, "--points")) {
        MeasuredPoint point;
        point.position = place;
        if (cloud) {
            const SnappedPoint snapped = snap(*cloud, place);
            moved = std::max(moved, snapped.distance);
            point = snapped.point;
        }
        measure.points.push_back(point);
    }
    values_of(measure);
    return measure;
}

// What is to be shown and written: the measures of --list, then the new one.
MeasureList list_with(const std::string& file, const std::optional<Measure>& added)
{
    MeasureList list;
    if (!file.empty()) list = MeasureList::read(file);
    if (added) list.add(*added);
    return list;
}

// Writes the files, and returns the list in them: where one of them is the list that was read, what other processes
// have added to it meanwhile is kept.
MeasureList write_files(const Arguments& arguments, const std::optional<Measure>& added,
                        const std::optional<CoordinateSystem>& system)
{
    MeasureList list = list_with(arguments.list, added);
    MeasureFiles others = arguments.files;
    for (const std::string& output : arguments.files.outputs) {
        std::error_code none;
        if (arguments.list.empty() || lower_extension(output) != ".json" ||
            !std::filesystem::equivalent(output, arguments.list, none))
            continue;
        update_file(output, [&] {
            list = list_with(arguments.list, added);
            return list.text();
        });
        others.outputs.erase(std::find(others.outputs.begin(), others.outputs.end(), output));
    }
    others.write(list, system);
    return list;
}

int run(const Arguments& arguments)
{
    if (arguments.kind.empty() && arguments.list.empty())
        throw UsageError("what to measure: give a kind with --points, or --list FILE");
    if (arguments.kind.empty() && !(arguments.points.empty() && arguments.from.empty() && arguments.surface.empty()))
        throw UsageError("points are of no use without a kind of measure");
    arguments.files.check();
    if (!arguments.list.empty()) MeasureList::read(arguments.list);  // refused before the work, not after it
    std::shared_ptr<PointCloud> cloud;
    if (!arguments.from.empty()) cloud = PointCloud::open(arguments.from);
    const auto system = cloud ? system_of(*cloud) : std::nullopt;
    const std::string unit = length_unit_of(system);
    double moved = 0;
    std::optional<Measure> added;
    if (!arguments.kind.empty()) added = measure_of(arguments, cloud.get(), moved);
    const MeasureList list = write_files(arguments, added, system);
    if (arguments.common.json) {
        Json json;
        json["measures"] = Json::array();
        for (std::size_t i = 0; i < list.size(); ++i) json["measures"].push_back(json_of(list[i], unit));
        if (cloud) json["largest_move"] = moved;
        json["unit"] = unit;
        if (const std::string caution = caution_of(system); !caution.empty()) json["notes"] = {caution};
        json["files"] = arguments.files.outputs;
        print_json(json);
        return 0;
    }
    if (const std::string caution = caution_of(system); !caution.empty()) std::printf("note: %s\n", caution.c_str());
    for (std::size_t i = 0; i < list.size(); ++i) print(list[i], unit);
    if (cloud) std::printf("places were moved to the nearest points, at most %s\n", brief(moved).c_str());
    for (const std::string& output : arguments.files.outputs)
        std::printf("%s: %zu %s\n", output.c_str(), list.size(), list.size() == 1 ? "measure" : "measures");
    return 0;
}

}  // namespace

Run add_measure(Options& options)
{
    auto arguments = std::make_shared<Arguments>();
    options
        .positional("kind", arguments->kind,
                    "point, distance (along two or more points), height (two), angle (three), area (of a polygon), "
                    "plane (the first point's distance to the plane through three or more others), or surface (a "
                    "point's distance to --surface)")
        .one_of(kinds());
    options.option("-p,--points", arguments->points, "Points x0 y0 z0 x1 y1 z1 ..., source coordinates: -p 0 0 0 3 4 0")
        .values(3, 1 << 20);
    options.option("--from", arguments->from,
                   "A tree: the points are moved to its nearest ones, whose spacing and grid give the uncertainty");
    options.option(
        "--surface", arguments->surface,
        "\"plane X Y Z NX NY NZ\", \"cylinder X Y Z AX AY AZ RADIUS\", \"sphere X Y Z RADIUS\", \"cone X Y Z AX AY "
        "AZ DEGREES\" (apex, axis inwards, half the opening angle) or \"torus X Y Z AX AY AZ RADIUS TUBE\"");
    options.option("--name", arguments->name, "Name of the measure (default: its kind and a number)");
    options.option("--list", arguments->list, "A list of measures (.json): shown, and written, before the new one");
    arguments->files.add_to(options);
    add_common(options, arguments->common);
    return [arguments] { return run(*arguments); };
}

}  // namespace pcm::cli
