#include "pcm/ops/shared/point_set_actions.h"

#include "pcm/cloud/las_class.h"
#include "pcm/io/writer.h"
#include "pcm/system/error.h"
#include "pcm/system/text.h"
#include "pcm/tree/tree.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdlib>

namespace pcm::ops {
namespace {

constexpr const char* las_classes = "classification";

// "7", "7.0", or "ground".
std::int64_t class_of(const std::string& text)
{
    char* end = nullptr;
    const double number = std::strtod(text.c_str(), &end);
    if (end != text.c_str() && *end == '\0') {
        if (std::fabs(number) < 1e15 && std::nearbyint(number) == number) return static_cast<std::int64_t>(number);
        throw Error(ErrorCode::invalid_argument, {}, "--classify " + text + " is not an integer");
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

Makes made(const SetChangeOptions& options) { return options.target.in_place ? Makes::changed : Makes::cloud; }

}  // namespace

SetDone save_set(const PointSet& set, const std::string& attribute, const SetChangeOptions& options)
{
    const SetChangeReport report = save_as_attribute(set, attribute, options);
    return {"saved", report.tree.string(), report.outcome.points_out, report.outcome, {}, made(options)};
}

SetDone classify_set(const PointSet& set, std::int64_t number, const std::string& attribute,
                     const SetChangeOptions& options)
{
    const SetChangeReport report = classify_points(set, number, attribute, options);
    SetDone done{"classified", report.tree.string(), report.outcome.points_out, report.outcome, {}, made(options)};
    done.number = number;
    done.subject = class_text(number, attribute) + " given to " + points_text(set.size());
    return done;
}

SetDone delete_set(const PointSet& set, const SetChangeOptions& options)
{
    const SetErasure erased = delete_points(set, options);
    SetDone done{"deleted", erased.tree.string(), erased.report.points_deleted, erased.report.outcome,
                 {},        made(options)};
    if (!erased.report.coverage_kept)
        done.notes.push_back("coarse levels have gaps where points were deleted; the operation compact closes them");
    return done;
}

SetDone extract_set(const PointSet& set, const std::string& output, const ExtractOptions& options)
{
    const ConvertReport report = extract_points(set, output, options);
    return {"extracted",    output,       report.outcome.points_out,
            report.outcome, report.notes, is_tree(output) ? Makes::cloud : Makes::file};
}

void PointSetActions::declare(Arguments& arguments, const std::string& group)
{
    arguments.add("save_attribute", attribute_)
        .only(Face::command)
        .group(group)
        .help(
            "Write this attribute (u8): 1 for the selected points, 0 for all others; --where NAME=1 selects them "
            "again. An attribute that was not made so is refused, unless --overwrite");
    arguments.add("extract", extract_)
        .as(ValueKind::output)
        .script("PointsOutput")
        .group(group)
        .label("Points to")
        .help("Write the points to this file, or tree (.pct)")
        .without("nowhere");
    arguments.add("overwrite", target_.overwrite)
        .group(group)
        .label("Overwrite")
        .help("Replace outputs that exist; write an attribute that the tree has from elsewhere, whose values are lost");
    arguments.add("delete", erase_).only(Face::command).group(group).help("Delete them");
    arguments.add("classify", classify_)
        .only(Face::command)
        .group(group)
        .help("Set their class, a number or a name of LAS: --classify 6, --classify building");
    arguments.add("class_attribute", classes_)
        .only(Face::command)
        .advanced()
        .group(group)
        .help("The integer attribute that --classify sets; made when absent");
    arguments.add("output", target_.output)
        .letter('o')
        .as(ValueKind::output_tree)
        .only(Face::command)
        .help("Tree folder to write: a copy that shares unchanged data with the original where the file system allows");
    arguments.add("in_place", target_.in_place).only(Face::command).help("Change the tree itself, atomically");
}

void PointSetActions::check(const std::string& tree, bool needs_action) const
{
    const auto refuse = [](const std::string& what) { throw ArgumentError(what); };
    const int actions = !attribute_.empty() + !extract_.empty() + erase_ + !classify_.empty();
    if (actions > 1) refuse("--save-attribute, --extract, --delete and --classify cannot be combined");
    const bool changes = actions == 1 && extract_.empty();
    const bool has_target = !target_.output.empty() || target_.in_place;
    if (changes && target_.output.empty() == !target_.in_place)
        refuse("give either -o COPY, a tree to write, or --in-place");
    if (!changes && has_target)
        refuse(
            "-o and --in-place are for --save-attribute, --delete and --classify; --extract names its output itself");
    if (target_.overwrite && actions == 0 && needs_action)
        refuse("--overwrite is for --extract, --save-attribute, --delete and --classify");
    // Before the work, not after it.
    if (changes) check_target(tree, {target_.output, target_.in_place, target_.overwrite});
}

SetDone PointSetActions::run(const PointSet& set, const Context& context, std::uint64_t memory, unsigned threads) const
{
    if (!extract_.empty()) {
        ExtractOptions options;
        options.overwrite = target_.overwrite;
        options.threads = threads;
        options.memory_bytes = std::max(memory, std::uint64_t(256) << 20);
        options.progress = context.progress;
        std::filesystem::path output = extract_;
        if (context.face == Face::dialog && output.extension().empty())
            output += std::string(".") + tree_extension;  // as all outputs of dialogs
        return extract_set(set, output.string(), options);
    }
    if (attribute_.empty() && !erase_ && classify_.empty()) return {};
    SetChangeOptions options;
    options.target = {target_.output, target_.in_place, target_.overwrite};
    options.memory_bytes = memory;
    options.threads = threads;
    options.overwrite = target_.overwrite;
    options.progress = context.progress;
    if (erase_) return delete_set(set, options);
    if (!classify_.empty()) return classify_set(set, class_of(classify_), classes_, options);
    return save_set(set, attribute_, options);
}

void put_done(Result& result, const SetDone& done)
{
    result.values["done"] = done.what.empty() ? Json() : Json(done.what);
    result.values["points_changed"] = done.changed;
    result.values["class"] = done.number ? Json(*done.number) : Json();
    result.notes.insert(result.notes.end(), done.notes.begin(), done.notes.end());
    result.outcome.warnings.insert(result.outcome.warnings.end(), done.outcome.warnings.begin(),
                                   done.outcome.warnings.end());
    if (done.what.empty()) return;
    result.output = done.output;
    result.makes = done.makes;
    if (!done.subject.empty())
        result.line(done.output + ": " + done.subject + ", " + grouped(done.changed) + " values changed");
    else if (done.what == "saved")
        result.line(done.output + ": " + grouped(done.changed) + " values changed");
    else
        result.line(done.output + ": " + points_text(done.changed) + " " + done.what);
}

std::vector<ResultKey> with_done_keys(std::vector<ResultKey> keys)
{
    keys.push_back({"done", "text?", "", "saved, extracted, classified or deleted; null: they were counted"});
    keys.push_back(
        {"points_changed", "count", "points", "points whose value was changed, or that were written or deleted"});
    keys.push_back({"class", "count?", "", "number that the points got"});
    return keys;
}

}  // namespace pcm::ops
