// Values of attributes, and new attributes, written in one atomic change.
#include "pcm/cloud/attribute_length.h"
#include "pcm/cloud/attribute_names.h"
#include "pcm/ops/shared/cache_report.h"
#include "pcm/ops/shared/level_arguments.h"
#include "pcm/ops/shared/region_arguments.h"
#include "pcm/ops/table.h"
#include "pcm/point_cloud.h"
#include "pcm/system/error.h"
#include "pcm/system/text.h"

#include <cmath>

namespace pcm::ops {
namespace {

[[noreturn]] void refuse_text(const std::string& text, const std::string& what, const std::string& hint)
{
    throw Error(ErrorCode::invalid_argument, {}, "'" + text + "': " + what, hint);
}

// "name:type" or "name:typexN"; then ":length", ":length^2", ... for values that grow with the cloud
Attribute parse_attribute(std::string text)
{
    const char* const expected =
        "write NAME:TYPE or NAME:TYPExN, such as height:f32 or tint:u8x3, and :length after it for lengths in source "
        "units";
    Attribute attribute;
    if (const auto unit = text.rfind(":length"); unit != std::string::npos && unit > 0) {
        attribute.description = std::string(attribute_unit::length) + text.substr(unit + 7);
        if (length_power(attribute) == 0) refuse_text(text, "the length has no exponent of one digit", expected);
        text.resize(unit);
    }
    const auto colon = text.rfind(':');
    if (colon == std::string::npos || colon == 0) refuse_text(text, "a name and a type are expected", expected);
    attribute.name = text.substr(0, colon);
    std::string type = text.substr(colon + 1);
    if (const auto x = type.find('x'); x != std::string::npos) {
        const std::string number = type.substr(x + 1);
        if (number.empty() || number.size() > 3 || number.find_first_not_of("0123456789") != std::string::npos ||
            std::stoul(number) == 0)
            refuse_text(text, "'" + number + "' is not a number of components", expected);
        attribute.components = static_cast<std::uint32_t>(std::stoul(number));
        type.resize(x);
    }
    for (std::uint8_t t = 0; t < 255; ++t)
        if (is_valid(static_cast<ScalarType>(t)) && name_of(static_cast<ScalarType>(t)) == type) {
            attribute.type = static_cast<ScalarType>(t);
            return attribute;
        }
    refuse_text(text, "unknown type '" + type + "'", "types are i8, u8, i16, u16, i32, u32, i64, u64, f32 and f64");
}

// "name=value", "name=value,value,value" (one value per component) or "name[component]=value"
struct Assignment {
    std::string name, text;
    std::optional<std::uint32_t> component;
    std::vector<double> values;
    std::size_t slot = 0;     // in the query's list
    std::vector<double> raw;  // what is stored
};

Assignment parse_assignment(const std::string& text)
{
    const char* const expected =
        "write NAME=VALUE, NAME=VALUE,VALUE,... with one value per component, or NAME[COMPONENT]=VALUE: "
        "classification=6";
    Assignment assignment;
    assignment.text = text;
    const auto written = written_name(text, "=");
    if (!written) refuse_text(text, "the quotes around the attribute's name do not match", expected);
    const std::size_t equals = written->end;
    if (equals == text.size() || written->name.empty()) refuse_text(text, "an attribute and = are expected", expected);
    assignment.name = written->name;
    if (!written->quoted && is_number(assignment.name))
        refuse_text(text, "an attribute stands before the =, and '" + assignment.name + "' is a number",
                    "an attribute of this name is written in quotes, as in \"'" + assignment.name + "'=2\"");
    if (const auto open = assignment.name.rfind('['); open != std::string::npos && !written->quoted) {
        const std::string number = assignment.name.substr(open + 1, assignment.name.size() - open - 2);
        if (assignment.name.back() != ']' || number.empty() || number.size() > 3 ||
            number.find_first_not_of("0123456789") != std::string::npos)
            refuse_text(text, "the brackets hold no component", expected);
        assignment.component = static_cast<std::uint32_t>(std::stoul(number));
        assignment.name.resize(open);
    }
    for (std::size_t at = equals + 1; at <= text.size();) {
        const std::size_t comma = std::min(text.find(',', at), text.size());
        const std::string word = text.substr(at, comma - at);
        std::size_t used = 0;
        try {
            assignment.values.push_back(std::stod(word, &used));
        } catch (const std::exception&) {
        }
        if (used == 0 || used != word.size()) refuse_text(text, "'" + word + "' is not a number", expected);
        at = comma + 1;
    }
    return assignment;
}

// Converts the values from what users see to what is stored.
void make_raw(Assignment& assignment, const Attribute& attribute)
{
    const std::size_t wanted = assignment.component ? 1 : attribute.components;
    if (assignment.values.size() != wanted)
        refuse_text(assignment.text,
                    "it has " + std::to_string(assignment.values.size()) + " values, not " + std::to_string(wanted),
                    "'" + attribute.name + "' has " + std::to_string(attribute.components) + " components");
    if (assignment.component && *assignment.component >= attribute.components)
        refuse_text(assignment.text,
                    "'" + attribute.name + "' has " + std::to_string(attribute.components) + " components",
                    "they are counted from 0");
    const bool scaled = attribute.scale != 1 || attribute.offset != 0;
    const bool real = attribute.type == ScalarType::f32 || attribute.type == ScalarType::f64;
    for (const double value : assignment.values) {
        double raw = scaled ? (value - attribute.offset) / attribute.scale : value;
        if (scaled && !real) raw = std::nearbyint(raw);
        assignment.raw.push_back(raw);
    }
}

// Finds the attributes of the assignments, and adds them to the query.
void resolve(std::vector<Assignment>& assignments, const Schema& schema, Query& query)
{
    for (Assignment& assignment : assignments) {
        const auto slot = schema.find(assignment.name);
        if (!slot) {
            std::string names;
            for (const Attribute& attribute : schema) names += (names.empty() ? "" : ", ") + attribute.name;
            refuse_text(assignment.text, "this cloud has no attribute '" + assignment.name + "'",
                        names.empty() ? "it has none; --new adds one" : "it has " + names + "; --new adds one");
        }
        make_raw(assignment, schema[*slot]);
        assignment.slot = query.attributes.size();
        query.attributes.push_back(assignment.name);
    }
}

void write(const std::vector<Assignment>& assignments, EditView& view)
{
    for (const Assignment& assignment : assignments)
        for (std::size_t i = 0; i < view.size(); ++i)
            for (std::size_t v = 0; v < assignment.raw.size(); ++v)
                view.set(i, assignment.slot, assignment.raw[v],
                         assignment.component.value_or(static_cast<std::uint32_t>(v)));
    view.mark_written();
}

struct Counts {
    std::uint64_t points = 0, chunks = 0;
    Outcome outcome;  // its warnings
};

// Atomic: when it throws, the tree is unchanged.
Counts change(PointCloud& cloud, const std::vector<Attribute>& added, std::vector<Assignment>& assignments, Query query)
{
    Counts set;
    try {
        for (const Attribute& attribute : added) cloud.add_attribute(attribute);
        resolve(assignments, cloud.info().schema, query);
        if (!assignments.empty()) {
            auto cursor = cloud.edit(query);
            for (EditView view; cursor.getNextData(view); ++set.chunks) {
                write(assignments, view);
                set.points += view.size();
            }
        }
        run_last_step(set.outcome, [&] { cloud.close(); });
    } catch (...) {
        cloud.abandon();
        throw;
    }
    return set;
}

class Set : public Operation {
public:
    Set()
    {
        arguments_.add("tree", tree_)
            .as(ValueKind::tree)
            .positional()
            .required()
            .help("Tree folder, or any file of it");
        arguments_.add("values", values_)
            .as(ValueKind::texts)
            .positional()
            .help("Assignments: NAME=VALUE, NAME=VALUE,VALUE,... (one value per component), NAME[COMPONENT]=VALUE");
        arguments_.add("new", attributes_)
            .as(ValueKind::texts)
            .help(
                "Attribute to add first, such as height:f32 or tint:u8x3; its values are 0. height:f32:length has "
                "lengths in source units, which grow when the cloud is scaled, area:f32:length^2 areas");
        const char* const group = "Points to change (default: all)";
        level_.declare(arguments_, "Only the points up to this level", group);
        region_.declare(arguments_, group);
        arguments_.add("cache", cache_.capacity_bytes)
            .as(ValueKind::bytes)
            .help("Cache for chunks, such as 256M or 2G");
        arguments_.add("statistics", statistics_).help("Print cache statistics");
    }

    Result answer(const Context& context) override
    {
        if (values_.empty() && attributes_.empty())
            throw ArgumentError("nothing is to be set: give NAME=VALUE, or --new NAME:TYPE");
        std::vector<Assignment> assignments;
        for (const std::string& text : values_) assignments.push_back(parse_assignment(text));
        Query query;
        query.choose(region_.get());
        query.progress = context.progress;
        std::vector<Attribute> added;
        for (const std::string& text : attributes_) added.push_back(parse_attribute(text));
        const auto cloud = PointCloud::open(tree_, cache_, Access::write);
        query.level = level_.of(*cloud->tree());
        const Counts set = change(*cloud, added, assignments, query);
        Result result;
        result.input = {tree_};
        result.output = tree_;
        result.makes = Makes::changed;
        result.outcome = set.outcome;
        result.accuracy = LevelArguments::accuracy(*cloud->tree(), query.level);
        result.outcome.points_out = set.points;
        const L2Statistics statistics = cloud->cache().statistics();
        Json& json = result.values;
        json["points_set"] = set.points;
        json["chunks_set"] = set.chunks;
        json["chunks_written"] = statistics.written_chunks;
        json["attributes_added"] = added.size();
        result.print("%s: %s points set in %s chunks, %s attributes added", tree_.c_str(), grouped(set.points).c_str(),
                     grouped(set.chunks).c_str(), grouped(added.size()).c_str());
        if (set.points == 0 && !assignments.empty())
            result.line("note: no point is selected; " + extent_text(cloud->info().bounds()));
        json["cache"] = Json();
        if (statistics_) {
            json["cache"] = cache_json(statistics);
            put_cache_lines(result, statistics);
        }
        return result;
    }

private:
    std::string tree_;
    std::vector<std::string> values_, attributes_;
    RegionArguments region_;
    LevelArguments level_;
    L2Options cache_;
    bool statistics_ = false;
};

}  // namespace

Row set_row()
{
    return {"set",
            nullptr,
            "Set attributes of a tree's points, and add attributes, atomically",
            "Sets attributes of the points in a region, and adds attributes, in one change of the tree: either all of "
            "it is done, or nothing.",
            0,
            nullptr,
            {{"points_set", "count", "points", "points whose values were set"},
             {"chunks_set", "count", "", "chunks with such points"},
             {"chunks_written", "count", "", "chunks that were written"},
             {"attributes_added", "count", "", "new attributes"},
             {"cache", "object?", "", "--statistics: of the cache of chunks"}},
            make<Set>,
            {"values"},
            follows_from_points_read};
}

}  // namespace pcm::ops
