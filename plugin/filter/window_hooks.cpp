#include "plugin/filter/window_hooks.h"

#include "pcm/io/writer.h"
#include "pcm/measure/measure_export.h"
#include "pcm/place/fit_at.h"
#include "pcm/system/error.h"
#include "plugin/filter/filter_paths.h"
#include "plugin/panels/open_tool.h"
#include "plugin/scene/drawn_primitives.h"
#include "plugin/scene/layer_matrix.h"
#include "plugin/scene/open_clouds.h"
#include "plugin/scene/primitive_book.h"
#include "plugin/scene/project_unit.h"
#include "plugin/scene/result_layer.h"
#include "plugin/scene/scene_state.h"
#include "plugin/scene/text.h"

#include <algorithm>
#include <array>

namespace pcm::host {

namespace {

constexpr const char* fit_tool = "Fit Primitives";  // its panel has the list

// Scripts of earlier versions lack parameters.
bool is_empty(const FilterRun& run, const char* name)
{
    return !run.parameters.has(name) || run.parameters.text(name).trimmed().isEmpty();
}

// ---- Layers.

// The current layer, where it is the one that shows the tree of the parameters; null: another one does, or none.
SceneLayer* shown_layer(const FilterRun& run)
{
    SceneLayer* const layer = run.scene.current();
    const auto shown = layer ? layer->tree() : std::nullopt;
    return shown && shown->cloud->tree()->folder() == tree_of(run.parameters, run.scene) ? layer : nullptr;
}

// Clouds as the window has them, so that points that are found are points of the layers.
void give_clouds(const FilterRun& run, ops::Window& window)
{
    const SceneLayer* const layer = shown_layer(run);
    window.open = [](const std::string& tree) { return open_cloud(tree); };
    if (layer) window.clip = clip_of(*layer);
    window.refuse_change = [&run](const std::string& tree) { refuse_locked(run.scene, tree); };
}

std::pair<SceneLayer*, LayerCloud> layer_with_tree(const FilterRun& run)
{
    SceneLayer* const layer = run.scene.current();
    auto shown = layer ? layer->tree() : std::nullopt;
    if (!shown)
        throw Error(ErrorCode::invalid_argument, {}, "the current layer shows no point cloud tree",
                    "choose a layer that does, or open a tree first");
    return {layer, std::move(*shown)};
}

// A tree that points were extracted to; the layer's matrix holds for it, too.
void show_extracted(const FilterRun& run, const ops::Result& result, const SceneLayer* layer)
{
    if (result.makes == ops::Makes::cloud)
        show_afterwards(run, [&] { return add_layer_of(run.scene, result.output, layer); });
}

// ---- Primitives.

std::string length_unit(const PointCloud& cloud) { return length_unit_of(coordinate_system_of(cloud.info().metadata)); }

std::string name_of_cloud(const FilterRun& run)
{
    const SceneLayer* const layer = shown_layer(run);
    return layer ? cloud_name(*layer) : tree_of(run.parameters, run.scene).string();
}

// Drawings have the coordinates of the cloud.
void note_matrix(const FilterRun& run)
{
    const SceneLayer* const layer = shown_layer(run);
    if (is_empty(run, "OutputFile") || !layer || !layer->placement()) return;
    run.log("The file has the cloud's own coordinates, without the matrix of its layer; Export Primitives applies it.");
}

void keep_found(const FilterRun& run, std::vector<Primitive>& found)
{
    static constexpr std::array<std::array<std::uint8_t, 3>, 3> colours{
        {{90, 190, 255}, {255, 200, 0}, {120, 220, 90}}};
    const std::string name = name_of_cloud(run);
    for (Primitive& primitive : found) {
        primitive.cloud = name;
        primitive.colour = colours[static_cast<std::size_t>(primitive.fit.shape.kind) % colours.size()];
    }
    run.scene.part<PrimitiveBook>().change([&](PrimitiveList& list) { list.add_all(found); });
    open_tool(run.scene, fit_tool);
}

void keep_fitted(const FilterRun& run, FittedPrimitive& fitted)
{
    PrimitiveBook& book = run.scene.part<PrimitiveBook>();
    Primitive& primitive = fitted.primitive;
    primitive.cloud = name_of_cloud(run);
    primitive.colour = next_colour(book.list());
    std::size_t index = 0;
    book.change([&](PrimitiveList& list) { index = list.add(primitive); });
    const auto points = std::make_shared<const PointSet>(fitted.points);
    book.keep_points(book.list()[index], points, fitted.reached);
    open_tool(run.scene, fit_tool);
    primitive = book.list()[index];
    if (primitive.fit.verdict == FitVerdict::doubtful)
        run.warn(primitive.name + " is doubtful: " + primitive.fit.message);
    if (const SceneLayer* const layer = shown_layer(run))
        run.scene.part<SceneState>().select(
            *layer, points,
            QString("%1, %2 points")
                .arg(QString::fromStdString(primitive.name), QString::fromStdString(grouped(points->size()))));
}

// The unit that all clouds of the primitives state, or the project's where they state none; empty where they differ.
std::string unit_of(const Scene& scene, const PrimitiveBook& book)
{
    std::vector<std::string> units;
    for (std::size_t i = 0; i < book.list().size(); ++i) {
        const SceneLayer* const layer = book.layer_of(book.list()[i]);
        const auto tree = layer ? layer->drawn() : std::nullopt;
        units.push_back(tree ? length_unit(*tree->cloud) : std::string());
    }
    const bool same = std::adjacent_find(units.begin(), units.end(), std::not_equal_to<>()) == units.end();
    if (!same) return {};
    const std::string stated = units.empty() ? std::string() : units.front();
    return stated.empty() ? chosen_unit(scene).value_or("") : stated;
}

ops::WindowPrimitives primitives_of(Scene& scene, bool applied, bool hidden_too)
{
    const PrimitiveBook& book = scene.part<PrimitiveBook>();
    if (book.list().empty())
        throw Error(ErrorCode::invalid_argument, {}, "the project has no primitives",
                    "fit some, or name a list (.json)");
    bool moved = false;
    for (std::size_t i = 0; i < book.list().size(); ++i) moved = moved || book.placement_of(book.list()[i]).has_value();
    ops::WindowPrimitives found{applied ? book.placed(hidden_too) : book.list().all(), unit_of(scene, book), {}};
    if (moved)
        found.notes.push_back(applied ? "The primitives are where the matrices of their layers move the clouds."
                                      : "The matrices of layers were not applied.");
    return found;
}

}  // namespace

OperationHooks at_points_of_layer()
{
    return {[](const FilterRun& run, ops::Operation& operation, ops::Window&) {
                if (run.parameters.has("Snap") && run.parameters.flag("Snap") && is_empty(run, "Tree"))
                    operation.arguments().find("from")->set({tree_of(run.parameters, run.scene).string()}, "Tree");
            },
            {}};
}

OperationHooks on_selection()
{
    return {[](const FilterRun& run, ops::Operation&, ops::Window& window) {
                auto [layer, shown] = layer_with_tree(run);
                SceneState& scene = run.scene.part<SceneState>();
                window.cloud = shown.cloud;
                window.clip = clip_of(*layer);
                window.selected = scene.selection(*layer);
                window.select = [&scene, layer = layer](PointSet points, const std::string& how) {
                    scene.select(*layer, std::make_shared<const PointSet>(std::move(points)),
                                 QString::fromStdString(how));
                };
            },
            [](const FilterRun& run, const ops::Operation& operation, const ops::Result& result) {
                if (operation.arguments().find("add_layer"))
                    show_extracted(run, result, run.scene.current());
                else
                    show_made(run, result);
            }};
}

OperationHooks fitting_primitives()
{
    return {[](const FilterRun& run, ops::Operation&, ops::Window& window) {
                give_clouds(run, window);
                window.keep_fit = [&run](FittedPrimitive& fitted) { keep_fitted(run, fitted); };
            },
            [](const FilterRun& run, const ops::Operation&, const ops::Result& result) {
                note_matrix(run);
                show_extracted(run, result, shown_layer(run));
            }};
}

OperationHooks finding_primitives()
{
    return {[](const FilterRun& run, ops::Operation&, ops::Window& window) {
                give_clouds(run, window);
                window.keep_primitives = [&run](std::vector<Primitive>& found) { keep_found(run, found); };
            },
            [](const FilterRun& run, const ops::Operation&, const ops::Result& result) {
                note_matrix(run);
                show_made(run, result);
            }};
}

OperationHooks exporting_primitives()
{
    return {[](const FilterRun& run, ops::Operation&, ops::Window& window) {
                window.primitives = [&run](bool moved, bool hidden_too) {
                    return primitives_of(run.scene, moved, hidden_too);
                };
            },
            {}};
}

}  // namespace pcm::host
