// Points that stand apart from the others are removed or labelled.
#include "pcm/filter/outliers.h"

#include "pcm/cluster/filter/team_outliers.h"
#include "pcm/ops/shared/attribute_report.h"
#include "pcm/ops/shared/target_arguments.h"
#include "pcm/ops/shared/work_arguments.h"
#include "pcm/ops/table.h"
#include "pcm/system/text.h"

namespace pcm::ops {
namespace {

const std::vector<Choice> methods{{"statistical", "Statistical"}, {"robust", "Robust"}, {"radius", "By radius"}};

class Outliers : public Operation {
public:
    Outliers()
    {
        target_.declare_cloud(arguments_);
        arguments_.choice("method", options_.method, methods)
            .label("Method")
            .help(
                "Which points are outliers. statistical: their mean distance to the neighbours is above mean + factor "
                "* deviation of all points; robust: above median + factor * 1.4826 * MAD, also where outliers are very "
                "far or very many; radius: they have fewer neighbours than given within the radius");
        arguments_.add("neighbours", options_.neighbours)
            .letter('k')
            .label("Neighbours")
            .between(1, most_neighbours)
            .help("Number of nearest neighbours");
        arguments_.add("factor", options_.factor)
            .letter('a')
            .label("Factor")
            .help("Factor of the deviation, more than 0; the larger, the fewer points are outliers");
        arguments_.add("radius", radius_)
            .label("Radius")
            .unit("source units")
            .positive()
            .help("Radius within which the method radius counts neighbours")
            .without("none");
        arguments_.add("label", options_.label)
            .label("Only label")
            .help("Remove nothing: write the attribute outlier, 1 for outliers and 0 for others");
        arguments_.add("count", options_.count_only)
            .script("CountOnly")
            .label("Count only")
            .help("Only report how many points would be removed; change nothing");
        target_.declare_target(arguments_, "outlier, of " + arguments_.find("label")->option_names() + ",");
        work_.declare(arguments_, least_filter_memory);
        flann_argument(arguments_, flann_);
    }

    Result answer(const Context& context) override
    {
        const bool by_radius = options_.method == OutlierMethod::radius;
        if (by_radius && !radius_)
            throw ArgumentError("the method radius needs " + called(context, "radius") +
                                ", within which neighbours are counted");
        if (!by_radius && radius_) throw ArgumentError(called(context, "radius") + " is for the method radius alone");
        options_.radius = radius_.value_or(0);
        options_.backend = flann_ ? NeighbourBackend::flann : NeighbourBackend::own;
        options_.overwrite = target_.overwrite;
        options_.memory_bytes = work_.memory;
        options_.threads = work_.threads;
        options_.progress = context.progress;
        work_.keep_memory_limit(called(context, "memory"));
        Result result;
        OutlierReport report;
        TargetChoice choice;
        if (!options_.count_only) choice = target_.choice(context.face, arguments_);
        if (context.team)
            report = remove_outliers_by(*context.team, target_.tree, choice, options_);
        else if (options_.count_only)
            report = remove_outliers(target_.tree, options_);
        else
            report = UpdateTarget(target_.tree, choice).update([&](const std::filesystem::path& folder) {
                return remove_outliers(folder, options_);
            });
        result.input = {target_.tree};
        if (!options_.count_only) target_.describe(result, choice.in_place ? target_.tree : target_.output);
        note_memory(report, options_.memory_bytes);
        put_report(result, report);
        put_values(result, report);
        write_lines(result, report);
        if (!report.coverage_kept && context.keeps_levels)
            result.notes.push_back(
                "coarse levels have gaps where points were removed; the operation compact closes them");
        return result;
    }

private:
    void put_values(Result& result, const OutlierReport& report) const
    {
        result.values["outliers"] = report.outliers;
        result.values["done"] = !options_.count_only;
        result.values["method"] = methods[static_cast<std::size_t>(options_.method)].name;
        result.values["centre"] = report.centre;
        result.values["deviation"] = report.deviation;
        result.values["threshold"] = report.threshold;
        result.values["levels_as_even_as_before"] = report.coverage_kept;
    }

    void write_lines(Result& result, const OutlierReport& report) const
    {
        const char* const done = options_.count_only ? "would be removed" : options_.label ? "labelled" : "removed";
        result.line((result.output.empty() ? target_.tree : result.output) + ": " + grouped(report.outliers) + " of " +
                    points_text(report.outcome.points_in) + " " + done);
        if (options_.method != OutlierMethod::radius)
            result.line("mean distance to " + std::to_string(options_.neighbours) +
                        " neighbours: " + (options_.method == OutlierMethod::robust ? "median " : "mean ") +
                        brief(report.centre) + ", deviation " + brief(report.deviation) + ", outliers above " +
                        brief(report.threshold) + " source units");
    }

    TargetArguments target_;
    WorkArguments work_;
    std::optional<double> radius_;
    bool flann_ = false;
    OutlierOptions options_;
};

}  // namespace

Row outliers_row()
{
    return {"outliers",
            "Remove Outliers of Point Cloud Tree",
            "Remove or label points that stand apart from the others",
            "Removes the points of a <b>point cloud tree</b> that stand apart from the others, or labels them with the "
            "attribute <i>outlier</i>, in a copy of the tree or in place. All distances and statistics are computed in "
            "double precision. Works on clouds larger than memory.",
            menu::points,
            "-clean.pct",
            {{"outliers", "count", "points", "points that stand apart"},
             {"done", "flag", "", "false: they were only counted"},
             {"method", "text", "", "which points are outliers"},
             {"centre", "number", "source units", "mean or median of the mean distances"},
             {"deviation", "number", "source units", "their deviation"},
             {"threshold", "number", "source units", "mean distance above which a point is an outlier"},
             {"levels_as_even_as_before", "flag", "", "false: coarse levels have gaps"}},
            make<Outliers>,
            {"neighbours", "factor"},
            always_exact};
}

}  // namespace pcm::ops
