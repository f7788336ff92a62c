#include "pcm/ops/shared/primitive_report.h"

#include "pcm/cad/primitive_files.h"
#include "pcm/cloud/numbers.h"
#include "pcm/shapes/outline_area.h"
#include "pcm/shapes/primitive_list.h"
#include "pcm/system/error.h"
#include "pcm/system/new_output.h"
#include "pcm/system/rounded_text.h"
#include "pcm/system/text.h"
#include "pcm/system/update_file.h"

#include <algorithm>

namespace pcm::ops {
namespace {

// Lines of names and values, in two columns.
struct Lines {
    Result& result;
    void operator()(const char* name, const std::string& value) const
    {
        std::string text = name;
        text.resize(std::max<std::size_t>(text.size(), 11), ' ');
        result.line("  " + text + " " + value);
    }
};

std::string with_error(double value, double error, const char* unit = "")
{
    return rounded_text(value, error) + " +- " + brief(error) + unit;
}

// An end of a shape is known as well as its points are.
void put_bounds(const Lines& line, const Primitive& primitive)
{
    const ShapeTraits& traits = traits_of(primitive.fit.shape.kind);
    const ShapeBounds& bounds = primitive.bounds;
    const double noise = primitive.fit.noise;
    if (!bounds.known(traits.kind)) return;
    if (traits.extent == ShapeExtent::outline)
        line("area", area_text(primitive) + ", " + std::to_string(bounds.outline.size()) + " corners");
    if (bounds.from < bounds.to) line("length", rounded_text(bounds.to - bounds.from, noise));
    if (traits.has_arc()) line("arc", brief((bounds.end - bounds.begin) / degree) + " degrees");
}

}  // namespace

std::string area_text(const Primitive& primitive)
{
    const OutlineArea found = area_of(primitive);
    return (found.uncertainty > 0 ? with_error(found.area, found.uncertainty) : brief(found.area)) + " " +
           words_of(found.form);
}

void put_lines(Result& result, const Primitive& primitive)
{
    const Lines line{result};
    const ShapeFit& fit = primitive.fit;
    const ShapeTraits& traits = traits_of(fit.shape.kind);
    result.line(std::string(traits.label) + ": " + name_of(fit.verdict) +
                (fit.message.empty() ? "" : " (" + fit.message + ")"));
    if (!fit.has_shape()) return;
    line(traits.place.name, rounded_text(fit.shape.point, fit.errors.position) + " +- " + brief(fit.errors.position));
    if (traits.has_axis())
        line(traits.axis_name(),
             rounded_text(fit.shape.axis, fit.errors.angle) + " +- " + brief(fit.errors.angle / degree) + " degrees");
    for (const ShapeSize& size : traits.sizes) {
        const double value = fit.shape.*size.value, error = fit.errors.*size.error;
        line(size.name, size.unit == SizeUnit::angle ? with_error(value / degree, error / degree, " degrees")
                                                     : with_error(value, error));
    }
    put_bounds(line, primitive);
    line("noise",
         brief(fit.noise) + ", within " + brief(fit.threshold) + " of the surface; condition " + brief(fit.condition));
    if (primitive.stations) line("stations", station_text(*primitive.stations));
    line("search", grouped(fit.iterations) + " samples by " + primitive.estimator + ", fit and growth in " +
                       time_text(fit.seconds));
}

Json json_of(const Primitive& primitive)
{
    if (primitive.fit.has_shape()) {
        Json json = Json::parse(pcm::json_of(std::vector<Primitive>{primitive}))["primitives"][0];
        if (const OutlineArea found = area_of(primitive); found.form != OutlineForm::none) {
            json["area"] = found.area;
            json["area_uncertainty"] = found.uncertainty > 0 ? Json(found.uncertainty) : Json();
            json["area_of"] = name_of(found.form);
        }
        return json;
    }
    return {{"kind", traits_of(primitive.fit.shape.kind).name},
            {"verdict", name_of(primitive.fit.verdict)},
            {"issue", name_of(primitive.fit.issue)},
            {"message", primitive.fit.message}};
}

namespace {

Json piece_json(const CentrePiece& piece)
{
    Json json{{"from", piece.from}, {"to", piece.to}, {"measured", piece.is_measured}};
    if (!piece.is_bend()) return json;
    json["angle"] = piece.angle;
    json["radius"] = piece.radius;
    json["centre"] = piece.centre;
    json["axis"] = piece.axis;
    return json;
}

}  // namespace

Json json_of(const std::vector<PipeRun>& runs)
{
    Json all = Json::array();
    for (const PipeRun& run : runs) {
        Json parts = Json::array(), line = Json::array();
        for (const Primitive* part : run.parts) parts.push_back(part->name);
        for (const CentrePiece& piece : run.line) line.push_back(piece_json(piece));
        all.push_back({{"name", run.name},
                       {"parts", parts},
                       {"radius", run.radius},
                       {"sigma_radius", run.radius_error > 0 ? Json(run.radius_error) : Json()},
                       {"length", run.length()},
                       {"sigma_length", run.length_error > 0 ? Json(run.length_error) : Json()},
                       {"is_closed", run.is_closed},
                       {"doubt", doubt_text(run)},
                       {"line", line}});
    }
    return all;
}

void put_lines(Result& result, const PipeRun& run, const std::string& unit)
{
    const std::string after = unit.empty() ? "" : " " + unit;
    result.line(run.name + ": " + parts_text(run));
    result.line("  radius " + (run.radius_error > 0 ? with_error(run.radius, run.radius_error) : brief(run.radius)) +
                after + ", length " +
                (run.length_error > 0 ? with_error(run.length(), run.length_error)
                                      : rounded_text(run.length(), run.radius / 100)) +
                after + ", " + bends_text(run) + (run.is_closed ? ", closed" : ""));
    if (const std::string doubt = doubt_text(run); !doubt.empty()) result.line("  doubtful: " + doubt);
}

namespace {

// Empty for a file that does not exist.
std::vector<Primitive> read_list(const std::filesystem::path& file)
{
    if (lower_extension(file) != ".json")
        throw Error(ErrorCode::invalid_argument, file, "a list of primitives is a file whose name ends in .json");
    check_output(file, true);
    std::error_code error;
    return std::filesystem::exists(file, error) ? read_primitives(file) : std::vector<Primitive>();
}

}  // namespace

void check_list(const std::filesystem::path& file) { read_list(file); }

void add_to_list(const std::filesystem::path& file, Primitive& primitive)
{
    Primitive added;
    update_file(file, [&] {
        PrimitiveList list;
        list.add_all(read_list(file));
        added = primitive;
        added.colour = next_colour(list);
        added = list[list.add(added)];
        return pcm::json_of(list.all());
    });
    primitive = added;
}

}  // namespace pcm::ops
