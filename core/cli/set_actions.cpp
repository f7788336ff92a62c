#include "pcm/cli/set_actions.h"

#include "pcm/cloud/las_class.h"
#include "pcm/filter/set_changes.h"
#include "pcm/system/error.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdio>
#include <cstdlib>

namespace pcm::cli {
namespace {

constexpr const char* las_classes = "classification";

// "7", "7.0", or "ground".
std::int64_t class_of(const std::string& text)
{
    char* end = nullptr;
    const double number = std::strtod(text.c_str(), &end);
    if (end != text.c_str() && *end == '\0') {
        if (std::fabs(number) < 1e15 && std::nearbyint(number) == number) return static_cast<std::int64_t>(number);
        throw Error(ErrorCode::invalid_argument, {}, "--classify " + text + " is no integer");
    }
    std::string name = text;
    for (char& c : name) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    for (unsigned code = 0; code < named_las_classes; ++code)
        if (las_class_name(code) == name) return code;
    throw Error(ErrorCode::invalid_argument, {}, "--classify: '" + text + "' is neither an integer nor a class of LAS",
                "give a number, such as 2, or a name, such as ground, building or \"low vegetation\"");
}

// "class 7 'low point (noise)'"; of another attribute "kind 7".
std::string class_text(std::int64_t number, const std::string& attribute)
{
    if (attribute != las_classes) return attribute + " " + std::to_string(number);
    const bool known = number >= 0 && number < 256;
    return "class " + std::to_string(number) +
           (known ? " '" + las_class_name(static_cast<unsigned>(number)) + "'" : std::string());
}

}  // namespace

void SetActions::add_to(Options& options, const char* group)
{
    options
        .option("--save-attribute", attribute_,
                "Write this attribute (u8): 1 for the selected points, 0 for all others; --where NAME=1 selects them "
                "again. An attribute that was not made so is refused, unless --overwrite")
        .group(group);
    options.option("--extract", extract_, "Write the points to this file, or tree (.pct)").group(group);
    options
        .flag("--overwrite", target_.overwrite,
              "Replace the output of --extract or -o if it exists; write --save-attribute where the tree has an "
              "attribute of this name from elsewhere, whose values are lost")
        .group(group);
    options.flag("--delete", erase_, "Delete them").group(group);
    options
        .option("--classify", classify_,
                "Set their class, a number or a name of LAS: --classify 6, --classify building")
        .group(group);
    options
        .option("--class-attribute", classes_,
                "The integer attribute that --classify sets (default classification); made when absent")
        .group(group);
    target_.add_to(options);
}

void SetActions::check(const std::string& tree) const
{
    const auto refuse = [](const std::string& what) { throw UsageError(what); };
    const int actions = !attribute_.empty() + !extract_.empty() + erase_ + !classify_.empty();
    if (actions > 1) refuse("--save-attribute, --extract, --delete and --classify cannot be combined");
    const bool changes = actions == 1 && extract_.empty();
    const bool has_target = !target_.output.empty() || target_.in_place;
    if (changes && target_.output.empty() == !target_.in_place)
        refuse("give either -o COPY, a tree to write, or --in-place");
    if (!changes && has_target)
        refuse(
            "-o and --in-place are for --save-attribute, --delete and --classify; --extract names its output itself");
    if (target_.overwrite && actions == 0)
        refuse("--overwrite is for --extract, --save-attribute, --delete and --classify");
    // Before the work, not after it.
    if (changes) check_target(tree, target_.get());
}

SetDone SetActions::change(const PointSet& set, const Common& common, std::uint64_t memory, unsigned threads) const
{
    SetChangeOptions options;
    options.target = target_.get();
    options.memory_bytes = memory;
    options.threads = threads;
    options.overwrite = target_.overwrite;
    options.progress = console_progress(common);
    SetDone done;
    if (erase_) {
        SetErasure erased = delete_points(set, options);
        done = {"deleted", erased.tree.string(), erased.report.points_deleted, erased.report.outcome, {}};
        if (!erased.report.coverage_kept)
            done.notes.push_back("coarse levels have gaps where points were deleted; 'pcmlab compact' closes them");
        return done;
    }
    if (!classify_.empty()) {
        const std::int64_t number = class_of(classify_);
        const SetChangeReport report = classify_points(set, number, classes_, options);
        done = {"classified", report.tree.string(), report.outcome.points_out, report.outcome, {}};
        done.number = number;
        done.subject = class_text(number, classes_) + " given to " + grouped(set.size()) + " points";
        return done;
    }
    const SetChangeReport report = save_as_attribute(set, attribute_, options);
    return {"saved", report.tree.string(), report.outcome.points_out, report.outcome, {}};
}

SetDone SetActions::run(const PointSet& set, const Common& common, std::uint64_t memory, unsigned threads) const
{
    if (extract_.empty()) {
        if (attribute_.empty() && !erase_ && classify_.empty()) return {};
        return change(set, common, memory, threads);
    }
    ExtractOptions options;
    options.overwrite = target_.overwrite;
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
    if (done.number) json["class"] = *done.number;
}

void print_done(const SetDone& done)
{
    if (!done.subject.empty())
        std::printf("%s: %s, %s values changed\n", done.output.c_str(), done.subject.c_str(),
                    grouped(done.changed).c_str());
    else if (done.what == "saved")
        std::printf("%s: %s values changed\n", done.output.c_str(), grouped(done.changed).c_str());
    else if (!done.what.empty())
        std::printf("%s: %s points %s\n", done.output.c_str(), grouped(done.changed).c_str(), done.what.c_str());
}

}  // namespace pcm::cli
