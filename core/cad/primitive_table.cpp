// Primitives and pipe runs as a table: RFC 4180.
#include "pcm/cad/drawing_list.h"
#include "pcm/cloud/numbers.h"
#include "pcm/shapes/outline_area.h"
#include "pcm/system/new_output.h"
#include "pcm/system/output_file.h"
#include "pcm/system/text.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <unordered_map>

namespace pcm {
namespace {

enum class ColumnUnit { none, length, angle };

// One column of the table. Empty: the primitive has no such number.
struct Column {
    std::string name;
    ColumnUnit unit;
    std::function<std::string(const Primitive& primitive)> text;
};

std::string number(double value) { return std::isfinite(value) ? exact(value) : value > 0 ? "inf" : ""; }
std::string angle(double value) { return number(value / degree); }
const ShapeTraits& traits(const Primitive& p) { return traits_of(p.fit.shape.kind); }
bool has_ends(const Primitive& p) { return traits(p).has_length() && p.bounds.known(p.fit.shape.kind); }
template <std::size_t A>
std::string point_at(const Primitive& p)
{
    return number(p.fit.shape.point[A]);
}
template <std::size_t A>
std::string axis_at(const Primitive& p)
{
    return traits(p).has_axis() ? number(p.fit.shape.axis[A]) : "";
}
template <std::size_t A, bool To>
std::string end_at(const Primitive& p)
{
    if (!has_ends(p)) return "";
    return number(p.fit.shape.point[A] + (To ? p.bounds.to : p.bounds.from) * p.fit.shape.axis[A]);
}

std::string arc_text(const Primitive& p)
{
    return traits(p).has_arc() && p.bounds.zero != Vec3d{} ? angle(p.bounds.end - p.bounds.begin) : "";
}

std::string area_text(const Primitive& p)
{
    const OutlineArea found = area_of(p);
    return found.form == OutlineForm::none ? "" : number(found.area);
}
std::string area_error_text(const Primitive& p)
{
    const OutlineArea found = area_of(p);
    return found.uncertainty > 0 ? number(found.uncertainty) : "";
}
std::string outline_text(const Primitive& p)
{
    const OutlineArea found = area_of(p);
    return found.form == OutlineForm::none ? "" : name_of(found.form);
}

std::string colour_text(const Primitive& p)
{
    char text[8];
    std::snprintf(text, sizeof text, "#%02x%02x%02x", p.colour[0], p.colour[1], p.colour[2]);
    return text;
}

// The numbers that kinds have in addition to place and axis, each once: lengths before angles.
std::vector<ShapeSize> all_sizes()
{
    std::vector<ShapeSize> all;
    for (const SizeUnit unit : {SizeUnit::length, SizeUnit::angle})
        for (const ShapeTraits& row : shape_kinds())
            for (const ShapeSize& size : row.sizes) {
                const auto is_it = [&](const ShapeSize& other) { return std::string(other.key) == size.key; };
                if (size.unit == unit && std::none_of(all.begin(), all.end(), is_it)) all.push_back(size);
            }
    return all;
}

// The size of the primitive's kind by its key, or the error of it.
std::string size_text(const Primitive& p, const std::string& key, bool is_error)
{
    for (const ShapeSize& size : traits(p).sizes) {
        if (size.key != key) continue;
        const double value = is_error ? p.fit.errors.*size.error : p.fit.shape.*size.value;
        return size.unit == SizeUnit::angle ? angle(value) : number(value);
    }
    return "";
}

using P = const Primitive&;
constexpr auto plain = ColumnUnit::none, length_unit = ColumnUnit::length, angle_unit = ColumnUnit::angle;

void add_sizes(std::vector<Column>& table, const std::string& prefix, bool are_errors)
{
    for (const ShapeSize& size : all_sizes()) {
        const std::string key = size.key;
        table.push_back({prefix + key, size.unit == SizeUnit::angle ? angle_unit : length_unit,
                         [key, are_errors](P p) { return size_text(p, key, are_errors); }});
    }
}

std::vector<Column> all_columns()
{
    std::vector<Column> table{
        {"name", plain, [](P p) { return p.name; }},
        {"kind", plain, [](P p) { return std::string(traits(p).name); }},
        {"colour", plain, colour_text},
        {"x", length_unit, point_at<0>},
        {"y", length_unit, point_at<1>},
        {"z", length_unit, point_at<2>},
        {"axis_x", plain, axis_at<0>},
        {"axis_y", plain, axis_at<1>},
        {"axis_z", plain, axis_at<2>},
    };
    add_sizes(table, "", false);
    table.push_back({"sigma_position", length_unit, [](P p) { return number(p.fit.errors.position); }});
    table.push_back(
        {"sigma_axis", angle_unit, [](P p) { return traits(p).has_axis() ? angle(p.fit.errors.angle) : ""; }});
    add_sizes(table, "sigma_", true);
    const std::vector<Column> others{
        {"rms", length_unit, [](P p) { return number(p.fit.rms); }},
        {"noise", length_unit, [](P p) { return number(p.fit.noise); }},
        {"threshold", length_unit, [](P p) { return number(p.fit.threshold); }},
        {"inliers", plain, [](P p) { return std::to_string(p.fit.inliers); }},
        {"points", plain, [](P p) { return std::to_string(p.points); }},
        {"length", length_unit, [](P p) { return has_ends(p) ? number(p.bounds.to - p.bounds.from) : ""; }},
        {"sigma_length", length_unit, [](P) { return std::string(); }},  // runs alone have one
        {"from_x", length_unit, end_at<0, false>},
        {"from_y", length_unit, end_at<1, false>},
        {"from_z", length_unit, end_at<2, false>},
        {"to_x", length_unit, end_at<0, true>},
        {"to_y", length_unit, end_at<1, true>},
        {"to_z", length_unit, end_at<2, true>},
        {"arc", angle_unit, arc_text},
        {"area", plain, area_text},
        {"sigma_area", plain, area_error_text},
        {"outline", plain, outline_text},  // outline whose area is given
        {"label", plain, [](P p) { return p.label ? std::to_string(p.label) : ""; }},
        {"verdict", plain, [](P p) { return std::string(name_of(p.fit.verdict)); }},
        {"message", plain, [](P p) { return p.fit.message; }},
        {"estimator", plain, [](P p) { return p.estimator; }},
        {"cloud", plain, [](P p) { return p.cloud; }},
    };
    table.insert(table.end(), others.begin(), others.end());
    return table;
}

const std::vector<Column>& columns()
{
    static const std::vector<Column> table = all_columns();
    return table;
}

std::string heading(const Column& column, CadUnit unit)
{
    const std::string name = column.name, length = name_of(unit);
    if (column.unit == ColumnUnit::angle) return name + " [deg]";
    if (length.empty()) return name;
    if (name == "area" || name == "sigma_area") return name + " [" + length + "^2]";
    return column.unit == ColumnUnit::length ? name + " [" + length + "]" : name;
}

// What a row of a run has in the columns of primitives, by their names.
std::unordered_map<std::string, std::string> cells_of(const PipeRun& run)
{
    const std::string doubt = doubt_text(run);
    std::uint64_t points = 0;
    for (const Primitive* part : run.parts) points += part->points;
    std::unordered_map<std::string, std::string> cells{
        {"name", run.name},
        {"kind", "pipe run"},
        {"colour", colour_text(*run.parts.front())},
        {"radius", number(run.radius)},
        {"sigma_radius", run.radius_error > 0 ? number(run.radius_error) : ""},
        {"length", number(run.length())},
        {"sigma_length", run.length_error > 0 ? number(run.length_error) : ""},
        {"points", std::to_string(points)},
        {"verdict", name_of(doubt.empty() ? FitVerdict::good : FitVerdict::doubtful)},
        {"message", doubt},
    };
    const char* const axes[] = {"_x", "_y", "_z"};
    for (std::size_t a = 0; a < 3; ++a) {
        cells[std::string("from") + axes[a]] = number(run.line.front().from[a]);
        cells[std::string("to") + axes[a]] = number(run.line.back().to[a]);
    }
    return cells;
}

// Name of the run that a primitive is a part of.
std::unordered_map<const Primitive*, std::string> runs_by_part(const std::vector<PipeRun>& runs)
{
    std::unordered_map<const Primitive*, std::string> names;
    for (const PipeRun& run : runs)
        for (const Primitive* part : run.parts) names[part] = run.name;
    return names;
}

}  // namespace

void write_table(const std::filesystem::path& file, const DrawingList& list, const CadOptions& options)
{
    OutputFile output(file);
    // The last three cells are what primitives and runs have of each other.
    const auto row = [&](const auto& text, const std::string& run, const std::string& bends, const std::string& parts) {
        std::string line;
        for (const Column& column : columns()) line += csv_field(text(column)) + ",";
        output.append(line + csv_field(run) + "," + bends + "," + csv_field(parts) + "\r\n");
    };
    row([&](const Column& column) { return heading(column, options.unit); }, "run", "bends", "parts");
    const auto run_of = runs_by_part(list.runs);
    for (const Primitive* primitive : list.shown) {
        const auto run = run_of.find(primitive);
        row([&](const Column& column) { return column.text(*primitive); }, run == run_of.end() ? "" : run->second, "",
            "");
    }
    for (const PipeRun& run : list.runs) {
        const auto cells = cells_of(run);
        const auto cell = [&](const Column& column) {
            const auto found = cells.find(column.name);
            return found == cells.end() ? std::string() : found->second;
        };
        row(cell, "", std::to_string(run.bends()), parts_text(run));
    }
    output.finish();
}

}  // namespace pcm
