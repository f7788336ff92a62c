#include "plugin/filter/primitive_parameters.h"

#include "pcm/measure/measure_export.h"
#include "pcm/system/error.h"
#include "pcm/system/new_output.h"
#include "plugin/filter/measure_parameters.h"
#include "plugin/filter/parameters.h"
#include "plugin/filter/result_parameters.h"
#include "plugin/meshlab/2020/document_scene.h"
#include "plugin/meshlab/2020/placement.h"
#include "plugin/scene/drawn_primitives.h"
#include "plugin/scene/scene_state.h"
#include "plugin/scene/text.h"

#include <algorithm>
#include <cmath>

namespace pcm::host {

namespace {

constexpr int stated = 0;  // the first choice of "Unit"; the others follow CadUnit

CadUnit unit_of(const RichParameterList& parameters, const std::string& symbol)
{
    const int choice = in_range(parameters, "Unit", "Unit", 0, 6);
    if (choice != stated) return static_cast<CadUnit>(choice - 1);
    return symbol == "m" ? CadUnit::metres : symbol == "ft" || symbol == "ftUS" ? CadUnit::feet : CadUnit::none;
}

}  // namespace

double number_of(const RichParameterList& parameters, const char* name, const char* label)
{
    const double value = decimal_of(parameters, name);
    if (value >= 0 && std::isfinite(value)) return value;
    throw Error(ErrorCode::invalid_argument, {}, std::string(label) + " is " + exact(value) + "; it must be 0 or more");
}

std::string length_unit(const PointCloud& cloud) { return length_unit_of(coordinate_system_of(cloud.info().metadata)); }

PrimitiveCloud primitive_cloud_of(const FilterRun& run)
{
    PrimitiveCloud found;
    const std::filesystem::path folder = tree_of(run.parameters, run.document);
    const MeshModel* layer = run.document.mm();
    const auto shown = layer ? Registry::instance().find(*layer) : std::nullopt;
    if (shown && shown->cloud->tree()->folder() == folder) {
        found.cloud = shown->cloud;
        found.layer = layer;
    } else {
        found.cloud = Registry::instance().open(folder);
    }
    found.unit = length_unit(*found.cloud);
    return found;
}

void add_limit_parameters(RichParameterList& parameters)
{
    parameters.addParam(
        RichString("Where", "", "Where",
                   "Only points that meet these conditions on attributes, separated by semicolons, take part. Example: "
                   "classification = 6; intensity >= 100. Empty, the default: all points."));
    parameters.addParam(
        RichBool("InClip", true, "Only what the clip box shows",
                 "Where the project has a clip box that is switched on, and the current layer shows the "
                 "tree, only points that it shows take part. Default on."));
}

Selection limit_of(const FilterRun& run, const PrimitiveCloud& cloud)
{
    Selection limit;
    limit.where = where_of(run.parameters);
    if (cloud.layer && run.parameters.getBool("InClip"))
        if (const auto clip = clip_of(layer_of(*cloud.layer))) limit.clips.push_back(*clip);
    return limit;
}

void add_drawing_parameters(RichParameterList& parameters, bool needed)
{
    const QString formats =
        ".dxf, .scr (a script for AutoCAD), .csv, or .json (a list that reads back), as its name ends";
    if (needed)
        parameters.addParam(RichString("OutputFile", "", "Output file",
                                       "File to write, in source coordinates: " + formats +
                                           ". A dialog proposes a name; scripts have no default."));
    else
        parameters.addParam(RichString(
            "OutputFile", "", "Output file",
            "File to write the result to, in source coordinates: " + formats + ". Empty, the default: no file."));
    parameters.addParam(RichBool("Overwrite", false, "Overwrite",
                                 "Replace the output file if it exists; otherwise that is an error. Default off."));
    parameters.addParam(RichEnum(
        "Unit", stated, {"As the cloud states", "None", "Metres", "Millimetres", "Centimetres", "Feet", "Inches"},
        "Unit",
        "What one source unit is. It is written where a format has units; numbers are never converted. Default 'As the "
        "cloud states'."));
    parameters.addParam(RichFloat("Chord", 0, "Chord",
                                  "Drawings: the largest distance of a mesh from its curved surface, source units. 0, "
                                  "the default: a hundredth of the radius."));
}

std::filesystem::path drawing_of(const RichParameterList& parameters) { return output_file_of(parameters); }

void check_drawing(const FilterRun& run)
{
    const std::filesystem::path file = drawing_of(run.parameters);
    if (file.empty()) return;
    check_primitive_file(file, overwrite_of(run.parameters));
}

void write_drawing(const FilterRun& run, const std::vector<Primitive>& primitives, const std::string& unit)
{
    const std::filesystem::path file = drawing_of(run.parameters);
    if (file.empty()) return;
    CadOptions options;
    options.unit = unit_of(run.parameters, unit);
    options.chord = number_of(run.parameters, "Chord", "Chord");
    options.overwrite = overwrite_of(run.parameters);
    const CadReport report = write_primitives(file, primitives, options);
    log_notes(run, report.notes);
    run.log(file.string() + ": " + grouped(report.written) + (report.written == 1 ? " primitive" : " primitives"));
}

void note_matrix(const FilterRun& run, const PrimitiveCloud& cloud)
{
    const auto tree = cloud.layer ? Registry::instance().find(*cloud.layer) : std::nullopt;
    if (drawing_of(run.parameters).empty() || !tree || !placement_of(*cloud.layer, *tree)) return;
    run.log("The file has the cloud's own coordinates, without the matrix of its layer; Export Primitives applies it.");
}

void log_primitive(const FilterRun& run, const Primitive& primitive, const std::string& unit)
{
    run.log(primitive.name + ":");
    for (const auto& [name, value] : lines_of(primitive, unit)) run.log("  " + (name + ": " + value).toStdString());
}

}  // namespace pcm::host
