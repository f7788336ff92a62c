// Export Primitives: the project's list, or a list in a file, as drawings and tables.
#include "pcm/system/error.h"
#include "pcm/system/new_output.h"
#include "plugin/filter/filter.h"
#include "plugin/filter/parameters.h"
#include "plugin/filter/primitive_parameters.h"
#include "plugin/meshlab/2020/document_scene.h"
#include "plugin/scene/primitive_book.h"
#include "plugin/scene/project_unit.h"

#include <algorithm>

namespace pcm::host {

namespace {

void add_parameters(RichParameterList& parameters)
{
    parameters.addParam(
        RichString("ListFile", "", "List",
                   "A list of primitives (.json) that is written in another format. Empty, the default: "
                   "the list of the project."));
    parameters.addParam(RichBool("ApplyMatrix", true, "Apply the matrices of layers",
                                 "Write the project's primitives where the matrices of their layers move the clouds, "
                                 "as views show them. Matrices that scale, shear or mirror are refused. Default on."));
    add_drawing_parameters(parameters, true);
}

// The unit that all clouds of the primitives state, or the project's where they state none; empty where they differ.
std::string unit_of(const Scene& scene, const PrimitiveBook& book)
{
    std::vector<std::string> units;
    for (std::size_t i = 0; i < book.list().size(); ++i) {
        const SceneLayer* layer = book.layer_of(book.list()[i]);
        const auto tree = layer ? layer->drawn() : std::nullopt;
        units.push_back(tree ? length_unit(*tree->cloud) : std::string());
    }
    const bool same = std::adjacent_find(units.begin(), units.end(), std::not_equal_to<>()) == units.end();
    if (!same) return {};
    const std::string stated = units.empty() ? std::string() : units.front();
    return stated.empty() ? chosen_unit(scene).value_or("") : stated;
}

void run(const FilterRun& run)
{
    if (drawing_of(run.parameters).empty())
        throw Error(ErrorCode::invalid_argument, {}, "no output file is given", "name the file to write");
    check_drawing(run);
    const PrimitiveBook& book = scene_of(run.document).part<PrimitiveBook>();
    const QString list = run.parameters.getString("ListFile").trimmed();
    if (!list.isEmpty()) return write_drawing(run, read_primitives(absolute_path(list)), {});
    if (book.list().empty())
        throw Error(ErrorCode::invalid_argument, {}, "the project has no primitives",
                    "fit some, or name a list (.json)");
    bool moved = false;
    for (std::size_t i = 0; i < book.list().size(); ++i) moved = moved || book.placement_of(book.list()[i]).has_value();
    const bool applied = run.parameters.getBool("ApplyMatrix");
    const bool everything = lower_extension(drawing_of(run.parameters)) == ".json";  // hidden ones too
    write_drawing(run, applied ? book.placed(everything) : book.list().all(), unit_of(scene_of(run.document), book));
    if (moved)
        run.log(applied ? "The primitives are where the matrices of their layers move the clouds."
                        : "The matrices of layers were not applied.");
}

}  // namespace

Filter export_primitives()
{
    using F = MeshFilterInterface;
    return {
        "Export Primitives",
        "Writes the primitives of the project's list, which the tool and filter <i>Fit Primitives</i> and the filter "
        "<i>Detect Primitives</i> make, as DXF, as a script for AutoCAD (SCR), as CSV with standard deviations, or "
        "as a list (JSON) that reads back; in source coordinates, moved by the matrices of their layers. Hidden ones "
        "are left out of drawings and tables.",
        F::Measure,
        add_parameters,
        run,
        "-primitives.dxf"};
}

}  // namespace pcm::host
