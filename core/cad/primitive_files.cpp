#include "pcm/cad/primitive_files.h"

#include "pcm/cad/drawing_list.h"
#include "pcm/cad/dxf_file.h"
#include "pcm/system/error.h"
#include "pcm/system/new_output.h"
#include "pcm/system/output_file.h"
#include "pcm/system/text.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>

namespace pcm {
namespace {

constexpr std::array<const char*, 6> unit_names{"", "m", "mm", "cm", "ft", "in"};

bool is_step(const std::string& extension) { return extension == ".step" || extension == ".stp"; }

}  // namespace

const char* name_of(CadUnit unit) { return unit_names[static_cast<std::size_t>(unit)]; }

std::optional<CadUnit> cad_unit(const std::string& name)
{
    for (std::size_t i = 0; i < unit_names.size(); ++i)
        if (name == unit_names[i]) return static_cast<CadUnit>(i);
    return {};
}

void check_primitive_file(const std::filesystem::path& file, bool overwrite)
{
    const std::string extension = lower_extension(file);
    const auto is_it = [&](const char* other) { return extension == other; };
    if (std::none_of(std::begin(cad_extensions), std::end(cad_extensions), is_it))
        throw Error(ErrorCode::invalid_argument, file, "the extension says no format of primitives",
                    "use .dxf, .step, .ifc, .scr, .csv or .json");
    if (extension == ".dxf") require_dxf(file);
    if (is_step(extension)) require_step(file);
    check_output(file, overwrite);
}

CadReport write_primitives(const std::filesystem::path& file, const std::vector<Primitive>& primitives,
                           const CadOptions& options)
{
    const std::string extension = lower_extension(file);
    check_primitive_file(file, options.overwrite);
    if (!(options.chord >= 0 && std::isfinite(options.chord)))
        throw Error(ErrorCode::invalid_argument, file, "the chord tolerance is not 0 or above");
    CadReport report;
    if (extension == ".json") {
        if (primitives.empty())
            throw Error(ErrorCode::invalid_argument, file, "there is no primitive to write: the list is empty");
        const std::string text = json_of(primitives);
        OutputFile output(file);
        output.append(text);
        output.finish();
        report.written = primitives.size();
        return report;
    }
    DrawingList list = drawing_list(primitives, extension != ".csv");
    if (extension == ".csv")
        write_table(file, list, options);
    else if (is_step(extension))
        write_step(file, list, options);
    else if (extension == ".ifc")
        write_ifc(file, list, options);
    else if (extension == ".scr")
        write_script(file, list, options);
    else
        write_drawing(file, list, options);
    report.written = list.shown.size();
    report.runs = list.runs.size();
    report.notes = list.notes;
    return report;
}

}  // namespace pcm
