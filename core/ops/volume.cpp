// Cut and fill between a tree's surface and a height, a plane or another tree.
#include "pcm/measure/volume.h"

#include "pcm/ops/shared/level_arguments.h"
#include "pcm/ops/shared/measure_report.h"
#include "pcm/ops/shared/region_arguments.h"
#include "pcm/ops/table.h"
#include "pcm/system/text.h"

#include <cstdio>
#include <utility>

namespace pcm::ops {
namespace {

enum class CompareWith : std::uint8_t { height, plane, tree };

// How much of the area the volume is known for.
std::string headline(const VolumeReport& report)
{
    const double percent = 100 * report.covered();
    if (percent >= 99.95) return "all of the area has points";
    char text[32];
    std::snprintf(text, sizeof text, percent < 1 ? "%.1f" : "%.0f", percent);
    return std::string(text) + " % of the area has points" +
           (report.area_interpolated > 0 ? ", the rest is interpolated" : ", the rest is left out");
}

void put_volume_lines(Result& result, const VolumeReport& report, const std::string& unit)
{
    for (const MeasureValue& value : report.values()) {
        if (value.unit != "^3") continue;
        std::string name = value.name;
        name.resize(std::max<std::size_t>(name.size(), 11), ' ');
        result.line(name + " " + text_of(value, unit) + (value.name == "net" ? ", " + headline(report) : ""));
    }
    result.line("cells       " + grouped(report.cells) + " of " + brief(report.side) + " wide; " +
                points_text(report.outcome.points_out));
    std::string area =
        "area        " + brief(report.area) + " in plan, " + brief(report.area_without_data) + " of it without points";
    if (report.area_interpolated > 0)
        area += std::string(": interpolated") +
                (report.area_extrapolated > 0 ? ", " + brief(report.area_extrapolated) + " extrapolated" : "");
    else if (report.area_without_data > 0)
        area += ": left out";
    result.line(area);
    result.line("uncertainty spread in cells " + brief(report.net_spread) + "; interpolation " +
                brief(report.net_gaps) + "; cells twice as wide change the net volume by " +
                brief(report.cut_coarse - report.fill_coarse - (report.cut_measured - report.fill_measured)));
}

void put_volume(Json& json, const VolumeReport& report)
{
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
    json["points_of_tree"] = report.points[0];
}

class Volume : public Operation {
public:
    Volume()
    {
        arguments_.add("tree", tree_)
            .as(ValueKind::tree)
            .positional()
            .required()
            .label("Tree folder")
            .help("The tree, whose points are the surface");
        arguments_.add("polygon", polygon_)
            .points(2, 3, 1 << 19)
            .label("Polygon")
            .help("Corners in plan, x0 y0 x1 y1 x2 y2 ..., source coordinates: 0 0 9 0 9 9")
            .without("the tree's box");
        declare_reference();
        declare_cells();
        limits_.declare_limits(arguments_, "Which points");
        arguments_.add("memory", options_.memory)
            .letter('m')
            .as(ValueKind::bytes)
            .script("MemoryMB")
            .label("Memory")
            .help("Memory for the cells, such as 2G")
            .advanced();
        arguments_.add("name", name_).label("Name").help("Name of the measure in files").without("Volume 1");
        files_.declare(arguments_);
    }

    Result answer(const Context& context) override
    {
        files_.check();
        set_reference(context);
        const auto cloud = context.open(tree_);
        check_level(*cloud->tree(), options_.level);
        if (!polygon_.empty())
            options_.polygon = plan_points_of(polygon_, called(context, "polygon"),
                                              cloud->info().points ? cloud->info().bounds().min[2] : 0);
        if (measured_only_ && interpolate_)
            throw ArgumentError("--interpolate and --measured-only contradict each other");
        if (context.face == Face::dialog ? !interpolate_ : measured_only_) options_.empty = EmptyCells::left_out;
        Selection limits = limits_.get();
        options_.where = std::move(limits.where);
        options_.clips = std::move(limits.clips);
        options_.progress = context.progress;
        const VolumeReport report = measure_volume(*cloud, options_);
        const auto system = system_of(*cloud);
        MeasureList list;
        list.add(measure_of(report, *cloud));
        files_.write(list, system);
        return result_of(report, system);
    }

private:
    void declare_reference()
    {
        arguments_
            .choice("compare_with", compare_with_, {{"height", "Height"}, {"plane", "Plane"}, {"tree", "Another tree"}})
            .only(Face::dialog)  // on the command line the option that is given is compared with
            .script("Reference")
            .label("Compare with")
            .help("Whether the surface is compared with 'Height', with 'Plane', or with another tree, 'Tree before'");
        arguments_.add("reference", reference_)
            .count(1)
            .script("Height")
            .in_dialogs("0")
            .label("Height")
            .unit("source units")
            .help("Height that the surface is compared with, such as 98.5");
        arguments_.add("plane", plane_)
            .count(6)
            .label("Plane")
            .help("Plane to compare with: a point x y z and a normal nx ny nz: 0 0 98 0 0.1 1");
        arguments_.add("before", before_)
            .as(ValueKind::file)
            .script("TreeBefore")
            .label("Tree before")
            .help("Tree whose surface is compared with: what was there before");
    }

    void declare_cells()
    {
        arguments_.add("side", options_.side)
            .letter('s')
            .positive()
            .unit("source units")
            .label("Side of a cell")
            .help("Side of the square cells")
            .automatic("so that cells that have points have about 9");
        arguments_.choice("height", options_.height, {{"mean", "Mean"}, {"lowest", "Lowest"}, {"highest", "Highest"}})
            .script("CellHeight")
            .label("Height of a cell")
            .help("Height of a cell: of its points the mean, lowest or highest");
        arguments_.add("interpolate", interpolate_)
            .label("Interpolate empty cells")
            .help(
                "Give cells without points heights from those around them, and the uncertainty what that may be wrong "
                "by; always, unless only the part that has points is measured")
            .on_in_dialogs();
        arguments_.add("measured_only", measured_only_)
            .only(Face::command)  // in dialogs the switch above does it
            .help(
                "Leave cells without points out: the volume of the part of the polygon that has points; the "
                "uncertainty "
                "contains the root mean square of the heights times the area left out");
        arguments_.add("level", options_.level)
            .letter('l')
            .label("Level")
            .help("Only the clouds at this level of detail: quicker")
            .without("all points");
    }

    void set_reference(const Context& context)
    {
        if (context.face == Face::dialog) {
            if (compare_with_ != CompareWith::height) reference_.clear();
            if (compare_with_ != CompareWith::plane) plane_.clear();
            if (compare_with_ != CompareWith::tree) before_.clear();
        }
        const int given = int(!reference_.empty()) + int(!plane_.empty()) + int(!before_.empty());
        if (given != 1)
            throw ArgumentError("what to compare with: give one of " + called(context, "reference") + ", " +
                                called(context, "plane") + " and " + called(context, "before"));
        const std::vector<double>& n = plane_;
        if (!reference_.empty())
            options_.reference.height = reference_[0];
        else if (!n.empty())
            options_.reference = plane_of({n[0], n[1], n[2]}, {n[3], n[4], n[5]});
        else
            options_.before = context.open(before_);
    }

    Measure measure_of(const VolumeReport& report, const PointCloud& cloud) const
    {
        Measure measure;
        measure.kind = MeasureKind::volume;
        measure.name = name_;
        measure.computed = report.values();
        std::vector<Vec3d> polygon = options_.polygon;
        if (polygon.empty()) polygon = plan_rectangle(cloud.info().bounds());
        for (const Vec3d& p : polygon) measure.points.push_back({p, 0, 0, tree_});
        return measure;
    }

    Result result_of(const VolumeReport& report, const std::optional<CoordinateSystem>& system) const
    {
        Result result;
        result.input = {tree_};
        if (!before_.empty()) result.input.push_back(before_);
        result.outcome = report.outcome;
        result.accuracy = from_deviation(report.outcome.error, "source units^3", "the net volume");
        result.notes = report.notes();
        if (const std::string caution = caution_of(system); !caution.empty())
            result.notes.insert(result.notes.begin(), caution);
        const std::string unit = length_unit_of(system);
        Json& values = result.values;
        values["before"] = before_.empty() ? Json() : Json(before_);
        put_volume(values, report);
        values["points_before"] = before_.empty() ? Json() : Json(report.points[1]);
        values["unit"] = unit;
        put_volume_lines(result, report, unit);
        files_.describe(result);
        return result;
    }

    MeasureFiles files_;
    std::string tree_, before_, name_;
    std::vector<double> polygon_, plane_, reference_;
    CompareWith compare_with_ = CompareWith::height;
    RegionArguments limits_;
    bool interpolate_ = false, measured_only_ = false;
    VolumeOptions options_;
};

std::vector<ResultKey> volume_keys()
{
    const char* const cubed = "source units^3";
    const char* const squared = "source units^2";
    return {{"before", "text?", "", "the tree that was compared with"},
            {"net", "number", cubed, "cut - fill"},
            {"net_uncertainty", "number", cubed, "one standard deviation"},
            {"cut", "number", cubed, "what lies above the reference"},
            {"cut_uncertainty", "number", cubed, "one standard deviation"},
            {"fill", "number", cubed, "what is missing below the reference"},
            {"fill_uncertainty", "number", cubed, "one standard deviation"},
            {"spread", "object", cubed, "net, cut, fill: the part of the heights' spread in cells"},
            {"coarser", "object", "", "cut, fill and side of cells twice as wide"},
            {"gaps", "object", cubed, "net, cut, fill: the part of interpolated cells"},
            {"excess", "number", cubed, "by which errors of heights make cut and fill larger"},
            {"side", "number", "source units", "side of a cell"},
            {"usual_side", "number", "source units", "side that is used where none is given"},
            {"cells", "count", "", "cells in the polygon"},
            {"cells_without_data", "count", "", "cells without points"},
            {"area", "number", squared, "of the polygon in plan"},
            {"covered", "number", "", "share of the area in cells that have points"},
            {"area_counted", "number", squared, "of the cells that count"},
            {"area_without_data", "number", squared, "of cells without points"},
            {"area_interpolated", "number", squared, "of interpolated cells"},
            {"area_extrapolated", "number", squared, "of those with points on one side only"},
            {"points_of_tree", "count", "points", "points of the tree in the polygon"},
            {"points_before", "count?", "points", "points of the tree before in the polygon"},
            {"unit", "text", "", "unit of lengths, as the tree states it; empty: not known"},
            {"files", "list", "", "files that were written"}};
}

}  // namespace

Row volume_row()
{
    return {"volume",
            "Cut Volume",
            "Volume between a tree's surface and a height, a plane or another tree: cut and fill",
            "Computes how much of a <b>point cloud tree</b>'s surface lies above (cut) and below (fill) a height, a "
            "plane or the surface of another tree, in a polygon seen from above, on a grid of square cells. The "
            "uncertainty comes from the spread of the heights in the cells, from cells twice as wide, and from the "
            "interpolation of cells without points. It takes clouds of any size in bounded memory.",
            menu::measure,
            nullptr,
            volume_keys(),
            make<Volume>,
            {},
            "It takes neither a time limit nor an error target: the error is known after the pass over the points "
            "alone. --level reads fewer of them."};
}

}  // namespace pcm::ops
