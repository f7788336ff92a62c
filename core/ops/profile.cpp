// The points of a tree along a line, as a cross-section shows them.
#include "pcm/measure/profile.h"

#include "pcm/cad/dxf_file.h"
#include "pcm/ops/shared/level_arguments.h"
#include "pcm/ops/shared/measure_report.h"
#include "pcm/ops/shared/region_arguments.h"
#include "pcm/ops/table.h"
#include "pcm/system/text.h"

#include <cmath>
#include <utility>

namespace pcm::ops {
namespace {

struct Extent {
    Box3d box;  // station, offset, z
    void add(const ProfilePoint& point) { box.extend(Vec3d{point.station, point.offset, point.position[2]}); }
    Json range(std::size_t axis) const { return box.empty() ? Json() : Json::array({box.min[axis], box.max[axis]}); }
    std::string text(std::size_t axis) const { return exact(box.min[axis]) + " to " + exact(box.max[axis]); }
};

class Profile : public Operation {
public:
    Profile()
    {
        arguments_.add("tree", tree_)
            .as(ValueKind::tree)
            .positional()
            .required()
            .label("Tree folder")
            .help("Tree folder, or any file of it");
        arguments_.add("line", line_)
            .points(2, 2, 1 << 19)
            .required()
            .label("Line")
            .help("Points of the line in plan, x0 y0 x1 y1 ..., source coordinates: 0 0 25 10");
        arguments_.add("width", options_.width)
            .letter('w')
            .not_negative()
            .unit("source units")
            .label("Width")
            .help("Width of the profile: points up to half of it on either side of the line");
        arguments_.add("heights", heights_)
            .count(2)
            .label("Heights")
            .help("Only points with z from LOW to HIGH, both included: 98 105");
        level_.declare(arguments_,
                       "Only the cloud at this level of detail: quicker, with the error that the answer states");
        arguments_.find("level")->letter('l');
        limits_.declare_limits(arguments_, "Which points");
        arguments_.add("attribute", options_.attributes)
            .letter('a')
            .script("Attributes")
            .label("Attributes")
            .help("Attribute to write to CSV in addition to station, offset, x, y and z; may be given several times");
        declare_file();
    }

    Result answer(const Context& context) override
    {
        const auto cloud = context.open(tree_);
        options_.level = level_.of(*cloud->tree());
        options_.line =
            plan_points_of(line_, called(context, "line"), cloud->info().points ? cloud->info().bounds().min[2] : 0);
        if (!heights_.empty()) {
            options_.lowest = heights_[0];
            options_.highest = heights_[1];
        }
        Selection limits = limits_.get();
        options_.where = std::move(limits.where);
        options_.clips = std::move(limits.clips);
        options_.progress = context.progress;
        const double length = ProfileLine(options_.line).length();
        Result result;
        result.input = {tree_};
        result.output = output_;
        if (!output_.empty()) result.makes = Makes::file;
        Extent extent;
        result.outcome =
            output_.empty()
                ? visit_profile(*cloud, options_,
                                [&](const ProfilePoint& p, const PointView&, std::size_t) { extent.add(p); })
                : write_profile(*cloud, options_, output_, file_);
        put(result, length, extent);
        return result;
    }

private:
    void declare_file()
    {
        arguments_.add("output", output_)
            .letter('o')
            .as(ValueKind::output)
            .script("OutputFile")
            .label("Output file")
            .help(writes_dxf() ? "File to write the points to: .csv, or .dxf, a drawing of heights over stations"
                               : "File to write the points to: .csv")
            .without("no file");
        arguments_.add("in_place", file_.in_place)
            .label("Drawing in place")
            .help("Drawings: points at their source coordinates, not at station and height");
        arguments_.add("exaggeration", file_.exaggeration)
            .label("Exaggeration")
            .help("Factor of heights in drawings that are not in place");
        arguments_.add("overwrite", file_.overwrite).label("Overwrite").help("Replace an existing output file");
    }

    void put(Result& result, double length, const Extent& extent) const
    {
        const Outcome& outcome = result.outcome;
        result.accuracy = without_finer_levels(outcome.error);
        Json& values = result.values;
        values["length"] = length;
        values["spacing"] = std::isfinite(outcome.error) ? Json(outcome.error) : Json();
        values["stations"] = extent.range(0);
        values["offsets"] = extent.range(1);
        values["heights"] = extent.range(2);
        result.line(points_text(outcome.points_out) + " of the profile, which is " + exact(length) + " long, in " +
                    time_text(outcome.seconds));
        if (!extent.box.empty()) {
            result.line("station     " + extent.text(0));
            result.line("offset      " + extent.text(1));
            result.line("height      " + extent.text(2));
        }
        if (outcome.error > 0)
            result.line("level " + std::to_string(*options_.level) + " only: every point of the cloud is nearer than " +
                        brief(outcome.error) + " to a point of this level");
        if (!output_.empty()) result.line(output_ + " written");
    }

    std::string tree_, output_;
    std::vector<double> line_, heights_;
    RegionArguments limits_;
    LevelArguments level_;
    ProfileOptions options_;
    ProfileFileOptions file_;
};

}  // namespace

Row profile_row()
{
    return {"profile",
            "Cross-Section Profile",
            "Profile of a tree along a line: the points in it, as CSV or DXF",
            "Finds the points of a <b>point cloud tree</b> along a line seen from above, within a width: for each its "
            "station along the line, its offset across and its height. Writes them to CSV, or to DXF as a drawing of "
            "heights over stations. It takes clouds of any size in bounded memory.",
            menu::measure,
            nullptr,
            {{"length", "number", "source units", "length of the line in plan"},
             {"spacing", "number?", "source units", "every point of the cloud is nearer to one of the level"},
             {"stations", "list?", "source units", "the least and the largest; null: a file was written, or no points"},
             {"offsets", "list?", "source units", "likewise"},
             {"heights", "list?", "source units", "likewise"}},
            make<Profile>,
            {},
            follows_from_points_read};
}

}  // namespace pcm::ops
