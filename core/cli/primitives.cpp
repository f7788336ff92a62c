#include "pcm/cad/primitive_files.h"

#include "pcm/cad/dxf_file.h"
#include "pcm/cli/common.h"
#include "pcm/cli/primitive_output.h"
#include "pcm/measure/measure.h"
#include "pcm/shapes/primitive_text.h"
#include "pcm/system/new_output.h"
#include "pcm/system/output_group.h"
#include "pcm/system/update_file.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>

namespace pcm::cli {
namespace {

constexpr double degree = pi / 180;

struct Arguments {
    Common common;
    std::string list, unit;
    std::vector<std::string> more, outputs;
    CadOptions options;
};

// "radius 0.3001 ± 0.0002 m"
std::string value_text(const char* name, double value, double sigma, const std::string& unit)
{
    if (!std::isfinite(sigma)) return std::string(name) + " " + brief(value) + " (not determined)";
    const bool is_angle = unit == "deg";
    return std::string(name) + " " +
           text_of(MeasureValue{name, value, sigma, is_angle ? unit : ""}, is_angle ? "" : unit);
}

void print(const Primitive& primitive, const std::string& unit)
{
    const ShapeFit& fit = primitive.fit;
    const ShapeTraits& traits = traits_of(fit.shape.kind);
    std::printf("%s%s\n", primitive.name.c_str(), primitive.hidden ? " (hidden)" : "");
    std::printf("  %s\n", place_text(fit).c_str());
    std::string sizes;
    const auto add = [&](const std::string& text) { sizes += (sizes.empty() ? "  " : ", ") + text; };
    if (traits.radius) add(value_text("radius", fit.shape.radius, fit.errors.radius, unit));
    if (fit.shape.kind == ShapeKind::torus) add(value_text("tube", fit.shape.second, fit.errors.second, unit));
    if (fit.shape.kind == ShapeKind::cone)
        add(value_text("half angle", fit.shape.second / degree, fit.errors.second / degree, "deg"));
    if (primitive.bounds.from < primitive.bounds.to)
        add("length " + brief(primitive.bounds.to - primitive.bounds.from) + (unit.empty() ? "" : " " + unit));
    if (!primitive.bounds.outline.empty())
        add("area " + area_text(primitive) + ", " + grouped(primitive.bounds.outline.size()) + " corners");
    if (!sizes.empty()) std::printf("%s\n", sizes.c_str());
    if (fit.inliers)
        std::printf("  %s inliers, rms %s%s%s\n", grouped(fit.inliers).c_str(), brief(fit.rms).c_str(),
                    unit.empty() ? "" : " ", unit.c_str());
    if (fit.verdict != FitVerdict::good) std::printf("  %s: %s\n", name_of(fit.verdict), fit.message.c_str());
}

std::vector<Primitive> read_all(const Arguments& arguments)
{
    std::vector<Primitive> primitives = read_primitives(arguments.list);
    for (const std::string& other : arguments.more)
        for (Primitive& primitive : read_primitives(other)) primitives.push_back(std::move(primitive));
    return primitives;
}

// Whether the output is a list that was read: then what other processes have added to it meanwhile is to be kept.
bool is_input(const std::string& output, const Arguments& arguments)
{
    const auto is_output = [&](const std::string& list) {
        std::error_code none;
        return std::filesystem::equivalent(output, list, none);
    };
    return lower_extension(output) == ".json" &&
           (is_output(arguments.list) || std::any_of(arguments.more.begin(), arguments.more.end(), is_output));
}

CadReport write(const std::string& output, std::vector<Primitive>& primitives, const Arguments& arguments)
{
    if (primitives.empty() || !is_input(output, arguments))
        return write_primitives(output, primitives, arguments.options);
    check_primitive_file(output, arguments.options.overwrite);
    update_file(output, [&] {
        primitives = read_all(arguments);
        return json_of(primitives);
    });
    return {primitives.size(), {}};
}

int run(Arguments& arguments)
{
    arguments.options.unit = *cad_unit(arguments.unit == "none" ? "" : arguments.unit);
    std::vector<Primitive> primitives = read_all(arguments);
    std::vector<std::string> notes;
    Json files = Json::array();
    const auto write_those = [&](bool inputs) {
        for (const std::string& output : arguments.outputs) {
            if (is_input(output, arguments) != inputs) continue;
            const CadReport report = write(output, primitives, arguments);
            files.push_back({{"file", output}, {"primitives", report.written}});
            for (const std::string& note : report.notes) notes.push_back(output + ": " + note);
        }
    };
    {
        OutputGroup group;
        write_those(false);
        group.put_in_place();
    }
    write_those(true);  // last: to add to a list again would add twice
    if (arguments.common.json) {
        Json json = Json::parse(json_of(primitives));
        json["unit"] = name_of(arguments.options.unit);
        json["files"] = files;
        json["notes"] = notes;
        print_json(json);
        return 0;
    }
    for (const Primitive& primitive : primitives) print(primitive, name_of(arguments.options.unit));
    if (primitives.empty()) std::printf("%s: no primitives\n", arguments.list.c_str());
    for (const Json& file : files) {
        const auto count = file["primitives"].get<std::size_t>();
        std::printf("%s: %zu %s\n", file["file"].get<std::string>().c_str(), count,
                    count == 1 ? "primitive" : "primitives");
    }
    for (const std::string& note : notes) std::printf("note: %s\n", note.c_str());
    return 0;
}

}  // namespace

Run add_primitives(Options& options)
{
    auto arguments = std::make_shared<Arguments>();
    arguments->unit = "none";
    options.positional("list", arguments->list, "A list of primitives (.json), as 'fit' and 'detect' write them")
        .required();
    options.option("--append", arguments->more, "Further lists, put behind the first").one_value_each();
    options
        .option("-o,--output,--to", arguments->outputs,
                std::string("Write the primitives to a file: ") +
                    (writes_dxf() ? ".dxf (a layer each, meshes and lines), " : "") +
                    ".scr (a script for AutoCAD, with true solids), .csv (parameters and their uncertainties), .json "
                    "(a list)")
        .one_value_each();
    options.option("--unit", arguments->unit, "What one unit of the coordinates is; written, not converted")
        .one_of({"none", "m", "mm", "cm", "ft", "in"})
        .show_default();
    options
        .option("--chord", arguments->options.chord,
                "Largest distance of a mesh from its curved surface, source units (default: a hundredth of the radius)")
        .positive();
    options.flag("--arcs", arguments->options.arcs,
                 "Draw cylinders and cones only as far around as their points go, open, instead of whole");
    options.flag("--overwrite", arguments->options.overwrite, "Replace existing files");
    add_common(options, arguments->common);
    return [arguments] { return run(*arguments); };
}

}  // namespace pcm::cli
