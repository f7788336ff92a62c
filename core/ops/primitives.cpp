// Lists of primitives: shown, joined, and written as drawings and tables.
#include "pcm/cad/primitive_files.h"

#include "pcm/cloud/numbers.h"
#include "pcm/measure/measure.h"
#include "pcm/ops/shared/drawing_arguments.h"
#include "pcm/ops/shared/primitive_report.h"
#include "pcm/ops/table.h"
#include "pcm/shapes/primitive_text.h"
#include "pcm/system/counted.h"
#include "pcm/system/new_output.h"
#include "pcm/system/output_group.h"
#include "pcm/system/text.h"
#include "pcm/system/update_file.h"

#include <algorithm>
#include <cmath>

namespace pcm::ops {
namespace {

// "radius 0.3001 ± 0.0002 m"
std::string value_text(const char* name, double value, double sigma, const std::string& unit)
{
    if (!std::isfinite(sigma)) return std::string(name) + " " + brief(value) + " (not determined)";
    const bool is_angle = unit == "deg";
    return std::string(name) + " " +
           text_of(MeasureValue{name, value, sigma, is_angle ? unit : ""}, is_angle ? "" : unit);
}

void put_brief_lines(Result& result, const Primitive& primitive, const std::string& unit)
{
    const ShapeFit& fit = primitive.fit;
    const ShapeTraits& traits = traits_of(fit.shape.kind);
    result.line(primitive.name + (primitive.hidden ? " (hidden)" : ""));
    result.line("  " + place_text(fit));
    std::string sizes;
    const auto add = [&](const std::string& text) { sizes += (sizes.empty() ? "  " : ", ") + text; };
    for (const ShapeSize& size : traits.sizes) {
        const double value = fit.shape.*size.value, error = fit.errors.*size.error;
        add(size.unit == SizeUnit::angle ? value_text(size.name, value / degree, error / degree, "deg")
                                         : value_text(size.name, value, error, unit));
    }
    if (primitive.bounds.from < primitive.bounds.to)
        add("length " + brief(primitive.bounds.to - primitive.bounds.from) + (unit.empty() ? "" : " " + unit));
    if (!primitive.bounds.outline.empty())
        add("area " + area_text(primitive) + ", " + grouped(primitive.bounds.outline.size()) + " corners");
    if (!sizes.empty()) result.line(sizes);
    if (fit.inliers)
        result.line("  " + grouped(fit.inliers) + " inliers, rms " + brief(fit.rms) + (unit.empty() ? "" : " " + unit));
    if (fit.verdict != FitVerdict::good) result.line(std::string("  ") + name_of(fit.verdict) + ": " + fit.message);
}

class Primitives : public Operation {
public:
    Primitives()
    {
        arguments_.add("list", list_)
            .as(ValueKind::file)
            .positional()
            .script("ListFile")
            .label("List")
            .help("A list of primitives (.json), as 'fit' and 'detect' write them")
            .without("in a window the list of the project");
        arguments_.add("append", more_)
            .as(ValueKind::texts)
            .label("Further lists")
            .help("Further lists, put behind the first")
            .advanced();
        arguments_.add("output", outputs_)
            .letter('o')
            .also("to")
            .as(ValueKind::outputs)
            .script("OutputFile")
            .label("Output file")
            .help("Write the primitives to a file, in source coordinates: " + drawing_formats());
        arguments_.add("apply_matrix", moved_)
            .only(Face::dialog)  // files have no layers
            .label("Apply the matrices of layers")
            .help(
                "Write the project's primitives where the matrices of their layers move the clouds, as views show "
                "them. Matrices that scale, shear or mirror are refused");
        drawing_.declare(arguments_);
        arguments_.add("overwrite", drawing_.overwrite).label("Overwrite").help("Replace existing files");
    }

    Result answer(const Context& context) override
    {
        if (context.face == Face::dialog && outputs_.empty())
            throw ArgumentError("no output file is given: name the file to write");
        if (list_.empty() && !context.window.primitives) throw ArgumentError("list is required");
        for (const std::string& output : outputs_)
            if (!is_input(output)) check_primitive_file(output, drawing_.overwrite);
        Result result;
        std::vector<Primitive> primitives = read(context, result);
        options_ = drawing_.options(unit_);
        Json files = Json::array();
        {
            OutputGroup group;
            write_those(false, primitives, files, result);
            group.put_in_place();
        }
        write_those(true, primitives, files, result);  // last: to add to a list again would add twice
        describe(result, primitives, files);
        return result;
    }

private:
    std::vector<Primitive> read(const Context& context, Result& result)
    {
        if (!list_.empty()) return read_all();
        // Lists keep hidden ones too.
        const bool hidden_too = std::any_of(outputs_.begin(), outputs_.end(), [](const std::string& output) {
            return lower_extension(output) == ".json";
        });
        WindowPrimitives found = context.window.primitives(moved_, hidden_too);
        unit_ = found.unit;
        result.notes = std::move(found.notes);
        return std::move(found.primitives);
    }

    std::vector<Primitive> read_all() const
    {
        std::vector<Primitive> primitives = read_primitives(list_);
        for (const std::string& other : more_)
            for (Primitive& primitive : read_primitives(other)) primitives.push_back(std::move(primitive));
        return primitives;
    }

    // Whether the output is a list that was read: then what other processes have added to it meanwhile is to be kept.
    bool is_input(const std::string& output) const
    {
        const auto is_output = [&](const std::string& list) {
            std::error_code none;
            return std::filesystem::equivalent(output, list, none);
        };
        return lower_extension(output) == ".json" &&
               (is_output(list_) || std::any_of(more_.begin(), more_.end(), is_output));
    }

    void write_those(bool inputs, std::vector<Primitive>& primitives, Json& files, Result& result) const
    {
        for (const std::string& output : outputs_) {
            if (is_input(output) != inputs) continue;
            const CadReport report = write(output, primitives);
            files.push_back({{"file", output}, {"primitives", report.written}, {"runs", report.runs}});
            for (const std::string& note : report.notes) result.notes.push_back(output + ": " + note);
        }
    }

    CadReport write(const std::string& output, std::vector<Primitive>& primitives) const
    {
        if (primitives.empty() || !is_input(output)) return write_primitives(output, primitives, options_);
        check_primitive_file(output, options_.overwrite);
        update_file(output, [&] {
            primitives = read_all();
            return pcm::json_of(primitives);
        });
        return {primitives.size(), 0, {}};
    }

    void describe(Result& result, const std::vector<Primitive>& primitives, const Json& files) const
    {
        if (!list_.empty()) result.input = {list_};
        result.input.insert(result.input.end(), more_.begin(), more_.end());
        if (!outputs_.empty()) {
            result.output = outputs_.front();
            result.makes = Makes::file;
        }
        result.accuracy = exact_answer();
        result.values = Json::parse(pcm::json_of(primitives));
        result.values.erase("version");  // the version of the list's format; the program's is in the head
        result.values["unit"] = name_of(options_.unit);
        result.values["files"] = files;
        const std::vector<PipeRun> runs = pipe_runs(primitives);
        result.values["runs"] = json_of(runs);
        for (const Primitive& primitive : primitives) put_brief_lines(result, primitive, name_of(options_.unit));
        for (const PipeRun& run : runs) put_lines(result, run, name_of(options_.unit));
        if (primitives.empty()) result.line(list_ + ": no primitives");
        for (const Json& file : files) {
            const auto drawn = file["runs"].get<std::uint64_t>();
            result.line(file["file"].get<std::string>() + ": " +
                        counted(file["primitives"].get<std::uint64_t>(), "primitive") +
                        (drawn == 0 ? "" : ", " + counted(drawn, "pipe run")));
        }
    }

    std::string list_, unit_;
    std::vector<std::string> more_, outputs_;
    bool moved_ = true;
    DrawingArguments drawing_;
    CadOptions options_;
};

}  // namespace

Row primitives_row()
{
    return {
        "primitives",
        "Export Primitives",
        "Show a list of primitives, or write it as DXF, as a script for AutoCAD, or as CSV",
        "Writes the primitives of the project's list, which the tool and filter <i>Fit Primitives</i> and the "
        "filter <i>Detect Primitives</i> make, or of a list in a file, as DXF, as a script for AutoCAD (SCR), as "
        "CSV with standard deviations, or as a list (JSON) that reads back; in source coordinates, moved by the "
        "matrices of their layers. Hidden ones are left out of drawings and tables. Pipes and elbows that continue "
        "each other are pipe runs in addition: with length and bends in the table, and with their centre line on a "
        "layer of its own in the DXF.",
        menu::measure,
        "-primitives.dxf",
        {{"format", "text", "", "pcm primitives"},
         {"angles", "text", "", "unit of angles: radians"},
         {"primitives", "list", "", "as in a list of primitives"},
         {"unit", "text", "", "unit of the coordinates; empty: not known"},
         {"runs", "list", "", pipe_runs_help},
         {"files", "list", "", "for each file that was written: file, and its numbers of primitives and pipe runs"}},
        make<Primitives>,
        {},
        always_exact};
}

}  // namespace pcm::ops
