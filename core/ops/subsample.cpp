// Points thinned evenly, to a spacing or a number.
#include "pcm/filter/subsample.h"

#include "pcm/ops/shared/result_arguments.h"
#include "pcm/ops/table.h"
#include "pcm/system/text.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace pcm::ops {
namespace {

enum class By : std::uint8_t { spacing, points };

class Subsample : public Operation {
public:
    Subsample()
    {
        to_.declare_inputs(arguments_);
        arguments_.choice("by", by_, {{"spacing", "Spacing"}, {"points", "Number of points"}})
            .only(Face::dialog)  // on the command line one of the two is given
            .label("Thin to")
            .help("Whether the spacing or the number of points counts");
        arguments_.add("spacing", options_.spacing)
            .letter('s')
            .in_dialogs("0.1")
            .spacing_in_dialogs()
            .unit("source units")
            .label("Spacing")
            .help(
                "No two points are nearer, and every point of the cloud has one that is; exactly, unless a level is "
                "taken");
        arguments_.add("points", options_.points)
            .letter('n')
            .in_dialogs("1000000")
            .label("Number of points")
            .help("Number of points of the result: exactly, unless a level is taken");
        arguments_.add("exact", options_.exact)
            .off_option("nearest-level",
                        "Quickly: the tree's level of detail whose spacing is nearest, which may be twice or half of "
                        "the one given, or all points; or the finest level with at most the number of points")
            .label("Exact")
            .help(
                "The spacing holds exactly, or the number of points. Off: quickly, the level of detail whose spacing "
                "is nearest, which may be twice or half of the one given, or all points; or the finest level with at "
                "most the number of points");
        to_.declare_target(arguments_);
        to_.declare_reading(arguments_);
    }

    Result answer(const Context& context) override
    {
        const TargetChoice choice = to_.target.choice(context.face, arguments_);
        if (context.face == Face::dialog) {
            if (by_ == By::spacing)
                options_.points.reset();
            else
                options_.spacing.reset();
        }
        if (options_.spacing.has_value() == options_.points.has_value())
            throw ArgumentError("what to thin to: give either --spacing or --points");
        const Sources sources(to_, choice, Sampling::poisson, context.progress);
        const SubsampleReport report = sources.apply(
            [&](const std::filesystem::path& tree, const ResultOptions& to) { return subsample(tree, options_, to); });
        Result result;
        sources.describe(result, report.build);
        if (!report.caveat.empty()) result.notes.push_back(report.caveat);
        result.accuracy = accuracy_of(report);
        result.values["exact"] = options_.exact;
        result.values["level"] = report.level ? Json(report.level->level) : Json();
        result.values["spacing"] = report.level       ? Json(report.level->spacing)
                                   : options_.spacing ? Json(*options_.spacing)
                                                      : Json();
        result.values["bytes"] = report.build.bytes;
        result.print("%s: %s points of %s (%s) in %.1f s, %s", result.output.c_str(),
                     grouped(result.outcome.points_out).c_str(), grouped(result.outcome.points_in).c_str(),
                     chosen_text(report).c_str(), result.outcome.seconds, bytes_text(report.build.bytes).c_str());
        return result;
    }

private:
    // By how much the level is not what was asked for.
    Accuracy accuracy_of(const SubsampleReport& report) const
    {
        if (!report.level) return exact_answer();
        const double unknown = std::numeric_limits<double>::infinity();
        if (options_.spacing)
            return bounded(report.caveat.empty() ? std::fabs(report.level->spacing - *options_.spacing) : unknown,
                           "the spacing");
        const auto asked = std::min(*options_.points, report.build.outcome.points_in);
        const std::uint64_t made = report.level->points, off = std::max(asked, made) - std::min(asked, made);
        if (off == 0) return exact_answer();
        return {ErrorKind::bound, static_cast<double>(off), "points", "the number of points"};
    }

    std::string chosen_text(const SubsampleReport& report) const
    {
        if (!report.level) {
            if (options_.spacing) return "spacing " + pcm::exact(*options_.spacing) + ", exactly";
            return "a level, and a part of the next";
        }
        return "level " + std::to_string(report.level->level) + ", " +
               (report.level->spacing > 0 ? "spacing " + brief(report.level->spacing) : "all points");
    }

    ResultArguments to_;
    By by_ = By::spacing;
    SubsampleOptions options_;
};

}  // namespace

Row subsample_row()
{
    return {"subsample",
            "Subsample Point Cloud Tree",
            "Thin a tree evenly, to a spacing or to a number of points",
            "Makes a <b>point cloud tree</b> of an evenly spread part of another one's points, which keep all their "
            "attributes: exactly a spacing, exactly a number of points, or a level of detail, which is quick. It takes "
            "clouds of any size in bounded memory.",
            menu::points | menu::sampling,
            "-thinned.pct",
            {{"exact", "flag", "", "false: a level of detail was taken"},
             {"level", "count?", "", "level of detail that was taken; null: the result is exact"},
             {"spacing", "number?", "source units", "spacing of the points; null: a number of points was requested"},
             {"bytes", "count", "bytes", "size of the result"}},
            make<Subsample>,
            {"spacing"},
            "It takes neither a time limit nor an error target: --spacing says how far points may be from the result, "
            "and --nearest-level is the quick answer."};
}

}  // namespace pcm::ops
