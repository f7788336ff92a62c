// Transform Point Cloud Tree: by the layer's matrix, or by numbers.
#include "pcm/build/builder.h"
#include "pcm/cloud/vector.h"
#include "pcm/system/error.h"
#include "plugin/filter/filter.h"
#include "plugin/filter/parameters.h"
#include "plugin/filter/result_parameters.h"
#include "plugin/filter/tree_target.h"
#include "plugin/meshlab/2020/document_scene.h"
#include "plugin/meshlab/2020/placement.h"
#include "plugin/meshlab/2020/registry.h"
#include "plugin/panels/operation.h"
#include "plugin/scene/moved_tree.h"
#include "plugin/scene/result_layer.h"
#include "plugin/scene/text.h"

namespace pcm::host {

namespace {

void add_parameters(RichParameterList& parameters)
{
    add_tree_parameter(parameters);
    parameters.addParam(RichBool("LayerMatrix", true, "The layer's matrix",
                                 "Apply the matrix of the layer that shows the tree, as the view does; MeshLab keeps "
                                 "it in single precision. Numbers below count after it. Default on."));
    parameters.addParam(RichString("Translate", "", "Translate",
                                   "dx dy dz, in source units, separated by blanks. Empty, the default: none."));
    parameters.addParam(RichString("Rotate", "", "Rotate",
                                   "An axis ax ay az and an angle in degrees, counter-clockwise where the axis points "
                                   "to the viewer: 0 0 1 30. About the pivot. Empty, the default: none."));
    parameters.addParam(RichFloat("Scale", 1, "Scale", "Factor, about the pivot. Default 1."));
    parameters.addParam(RichString("Pivot", "", "Pivot",
                                   "x y z, source coordinates, that rotation and scale leave in place. Empty, the "
                                   "default: the centre of the cloud's box."));
    add_result_parameters(parameters, false);
}

// The typed numbers; nothing where none were.
std::optional<Affine> typed_map(const RichParameterList& parameters, const Box3d& box)
{
    const auto translate = numbers_of(parameters, "Translate", "Translate", 3);
    const auto rotate = numbers_of(parameters, "Rotate", "Rotate", 4);
    const auto point = numbers_of(parameters, "Pivot", "Pivot", 3);
    const double scale = decimal_of(parameters, "Scale");
    if (!translate && !rotate && scale == 1) return std::nullopt;
    Vec3d pivot = box.empty() ? Vec3d{0, 0, 0} : box.centre();
    if (point) pivot = {(*point)[0], (*point)[1], (*point)[2]};
    Affine map;
    if (rotate && (*rotate)[3] != 0) {
        const Vec3d axis{(*rotate)[0], (*rotate)[1], (*rotate)[2]};
        if (axis == Vec3d{0, 0, 0})
            throw Error(ErrorCode::invalid_argument, {}, "the axis of Rotate has length zero",
                        "0 0 1 30 rotates by 30 degrees about the vertical axis");
        map = Affine::rotation(axis, (*rotate)[3] * pi / 180, pivot, scale);
    } else if (scale != 1) {  // positions keep their grid
        map.pivot = map.target = pivot;
        for (std::size_t a = 0; a < 3; ++a) map.linear[a][a] = scale;
    }
    for (std::size_t a = 0; a < 3 && translate; ++a) map.target[a] += (*translate)[a];
    return map;
}

// The map of the layer: the current one where no tree is named, else the first that shows the tree.
std::optional<Affine> layer_map(const FilterRun& run, const std::filesystem::path& tree)
{
    const bool named = !run.parameters.getString("Tree").trimmed().isEmpty();
    for (const MeshModel* layer : run.document.meshList) {
        const auto shown = Registry::instance().find(*layer);
        std::error_code ignored;
        if (!shown || (!named && layer != run.document.mm()) ||
            !std::filesystem::equivalent(shown->cloud->tree()->folder(), tree, ignored))
            continue;
        return placement_of(*layer, *shown);
    }
    return std::nullopt;
}

void run(const FilterRun& run)
{
    const std::filesystem::path path = tree_of(run.parameters, run.document);
    const ResultOptions result = result_options_of(run.parameters);
    const auto tree = Tree::open(path);
    const auto first = run.parameters.getBool("LayerMatrix") ? layer_map(run, path) : std::nullopt;
    const auto second = typed_map(run.parameters, tree->info().bounds());
    if (!first && !second)
        throw Error(ErrorCode::invalid_argument, {}, "no transformation was given, and the layer has no matrix",
                    "move the layer, or give a translation, a rotation or a scale");
    std::vector<Affine> maps;
    for (const auto& map : {first, second})
        if (map) maps.push_back(*map);
    BuildOptions build;
    build.memory_bytes = result.memory_bytes;
    build.threads = result.threads;
    build.overwrite = result.overwrite;
    Operation operation(run.callback);
    build.progress = operation.progress();
    const BuildReport report = write_moved_tree(tree, maps, result.target.copy, build);
    log_result(run, "Transformed " + path.string() + (first ? ", by the layer's matrix" : ""), report);
    run.log("Largest position error: " + exact(report.outcome.error) + " source units.");
    SceneLayer* const former = layer_showing(scene_of(run.document), path);
    show_moved_result(run, result.target.copy, former ? std::vector<SceneLayer*>{former} : std::vector<SceneLayer*>());
}

}  // namespace

Filter transform()
{
    using F = MeshFilterInterface;
    return {"Transform Point Cloud Tree",
            "Writes a <b>point cloud tree</b> that is moved, turned or scaled: by the layer's matrix, as MeshLab's "
            "own tools set it, by numbers, or both. The new layer has no matrix, and its points are where the old "
            "layer shows them. The old tree stays as it is. Esc cancels it.",
            F::FilterClass(F::MeshCreation | F::PointSet | F::Normal),
            add_parameters,
            run,
            "-moved.pct"};
}

}  // namespace pcm::host
