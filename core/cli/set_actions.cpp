#include "pcm/cli/set_actions.h"

#include "pcm/select/set_changes.h"
#include "pcm/system/error.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace pcm::cli {

void SetActions::add_to(Options& options, const char* group)
{
    options
        .option("--save-attribute", attribute_,
                "Write this attribute (u8): 1 for the selected points, 0 for all others; --where NAME=1 selects them "
                "again")
        .group(group);
    options.option("--extract", extract_, "Write the points to this file, or tree (.pct)").group(group);
    options.flag("--overwrite", overwrite_, "Replace the output of --extract if it exists").group(group);
    options.flag("--delete", erase_, "Delete them").group(group);
    options.option("--classify", classify_, "Set their class: --classify 6").group(group);
    options
        .option("--class-attribute", classes_,
                "The integer attribute that --classify sets (default classification); made when absent")
        .group(group);
    target_.add_to(options);
}

void SetActions::check() const
{
    const auto refuse = [](const std::string& what) { throw UsageError(what); };
    const int actions = !attribute_.empty() + !extract_.empty() + erase_ + classify_.has_value();
    if (actions > 1) refuse("--save-attribute, --extract, --delete and --classify cannot be combined");
    const bool changes = actions == 1 && extract_.empty();
    const bool has_target = !target_.output.empty() || target_.in_place;
    if (changes && target_.output.empty() == !target_.in_place)
        refuse("give either -o COPY, a tree to write, or --in-place");
    if (!changes && has_target)
        refuse(
            "-o and --in-place are for --save-attribute, --delete and --classify; --extract names its output itself");
    if (overwrite_ && extract_.empty()) refuse("--overwrite is for --extract");
}

SetDone SetActions::change(const PointSet& set, const Common& common, std::uint64_t memory, unsigned threads) const
{
    SetChangeOptions options;
    options.target = target_.get();
    options.memory_bytes = memory;
    options.threads = threads;
    options.progress = console_progress(common);
    SetDone done;
    if (erase_) {
        SetErasure erased = delete_points(set, options);
        done = {"deleted", erased.tree.string(), erased.report.points_deleted, erased.report.outcome, {}};
        if (!erased.report.coverage_kept)
            done.notes.push_back("coarse levels have gaps where points were deleted; 'pcmlab compact' closes them");
        return done;
    }
    const bool classifies = classify_.has_value();
    if (classifies && !(std::fabs(*classify_) < 1e15 && std::nearbyint(*classify_) == *classify_))
        throw Error(ErrorCode::invalid_argument, {}, "--classify " + exact(*classify_) + " is no integer");
    const SetChangeReport report = classifies
                                       ? classify_points(set, static_cast<std::int64_t>(*classify_), classes_, options)
                                       : save_as_attribute(set, attribute_, options);
    return {classifies ? "classified" : "saved", report.tree.string(), report.outcome.points_out, report.outcome, {}};
}

SetDone SetActions::run(const PointSet& set, const Common& common, std::uint64_t memory, unsigned threads) const
{
    if (extract_.empty()) {
        if (attribute_.empty() && !erase_ && !classify_) return {};
        return change(set, common, memory, threads);
    }
    ExtractOptions options;
    options.overwrite = overwrite_;
    options.threads = threads;
    options.memory_bytes = std::max(memory, std::uint64_t(256) << 20);
    options.progress = console_progress(common);
    const ConvertReport report = extract_points(set, extract_, options);
    return {"extracted", extract_, report.outcome.points_out, report.outcome, report.notes};
}

void put_done(Json& json, const SetDone& done)
{
    json["done"] = done.what.empty() ? Json() : Json(done.what);
    json["output"] = done.output.empty() ? Json() : Json(done.output);
    json["points_changed"] = done.changed;
}

void print_done(const SetDone& done)
{
    if (done.what == "saved" || done.what == "classified")
        std::printf("%s: %s values changed\n", done.output.c_str(), grouped(done.changed).c_str());
    else if (!done.what.empty())
        std::printf("%s: %s points %s\n", done.output.c_str(), grouped(done.changed).c_str(), done.what.c_str());
}

}  // namespace pcm::cli
