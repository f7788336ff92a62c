#include "plugin/scene/primitive_book.h"

#include "pcm/cad/primitive_files.h"
#include "pcm/shapes/moved_primitive.h"
#include "pcm/system/error.h"
#include "plugin/scene/annotations.h"
#include "plugin/scene/drawn_primitives.h"
#include "plugin/scene/layer_matrix.h"
#include "plugin/scene/project_parts.h"
#include "plugin/scene/reached_text.h"

#include <QCoreApplication>

#include <filesystem>
#include <utility>

namespace pcm::host {

namespace {

const char* const list_element = "PointCloudPrimitives";
const char* const reached_element = "PointCloudPrimitivePoints";
const char* const owner = "primitives";
constexpr std::size_t most_labels = 30;    // with more of them only the selected one has a label
constexpr int look_ms = 400;               // at the matrices of layers
constexpr std::size_t most_seeds = 20000;  // maximum number of a primitive's seeds that projects keep

// The key of its points: the same for the same shape in the same cloud, whatever its name is.
std::string key_of(const Primitive& primitive) { return text_of(primitive.fit.shape) + "\n" + primitive.cloud; }

bool same_map(const std::optional<Affine>& a, const std::optional<Affine>& b)
{
    if (!a || !b) return !a && !b;
    return a->linear == b->linear && a->pivot == b->pivot && a->target == b->target;
}

}  // namespace

std::string cloud_name(const SceneLayer& layer)
{
    const auto tree = layer.drawn();
    return tree && !tree->is_copy() ? tree->cloud->tree()->folder().string() : layer.label().toStdString();
}

PrimitiveBook::PrimitiveBook(Scene& scene) : ListBook(scene)
{
    timer_.setInterval(look_ms);
    connect(&timer_, &QTimer::timeout, this, &PrimitiveBook::follow_matrices);
    connect(&scene.part<LayerMatrices>(), &LayerMatrices::changed, this, &PrimitiveBook::follow_matrices);
    connect(&scene, &Scene::cloud_detached, this, [this] {
        for (auto each = points_.begin(); each != points_.end();)
            each = is_drawn(each->second->tree()) ? std::next(each) : points_.erase(each);
    });
}

SceneLayer* PrimitiveBook::layer_of(const Primitive& primitive) const
{
    SceneLayer* moved = nullptr;  // the project and its trees may have been moved
    const std::filesystem::path path = primitive.cloud;
    for (SceneLayer* layer : scene_.layers()) {
        if (!layer || !layer->drawn()) continue;
        const std::string name = cloud_name(*layer);
        if (name == primitive.cloud) return layer;
        if (!moved && std::filesystem::path(name).filename() == path.filename()) moved = layer;
    }
    std::error_code error;
    return moved && !std::filesystem::exists(path, error) ? moved : nullptr;  // else it is another cloud
}

std::optional<Affine> PrimitiveBook::placement_of(const Primitive& primitive) const
{
    const SceneLayer* layer = layer_of(primitive);
    const auto tree = layer ? layer->drawn() : std::nullopt;
    return tree ? layer->placement() : std::nullopt;
}

std::vector<Primitive> PrimitiveBook::placed(bool hidden_too) const
{
    std::vector<Primitive> all = list().all();
    for (Primitive& primitive : all) {
        const auto placement = placement_of(primitive);
        if (!placement || (primitive.hidden && !hidden_too)) continue;
        if (!rotation_of(placement->linear))
            throw Error(
                ErrorCode::invalid_argument, {},
                "the matrix of the layer " + layer_of(primitive)->label().toStdString() +
                    " scales, shears or mirrors " + primitive.name,
                "undo that, make a moved cloud by Transform Point Cloud and fit there, or hide " + primitive.name);
        primitive = moved(primitive, *placement);
    }
    return all;
}

bool PrimitiveBook::is_drawn(const Tree& tree) const
{
    for (const SceneLayer* layer : scene_.layers()) {
        const auto drawn = layer ? layer->drawn() : std::nullopt;
        if (drawn && drawn->cloud->tree()->folder() == tree.folder()) return true;
    }
    return false;
}

void PrimitiveBook::keep_points(const Primitive& primitive, std::shared_ptr<const PointSet> points,
                                std::optional<ReachedFrom> reached)
{
    points_[key_of(primitive)] = std::move(points);
    if (reached && !reached->seeds.empty() && reached->seeds.size() <= most_seeds)
        reached_[key_of(primitive)] = std::move(*reached);
}

const ReachedFrom* PrimitiveBook::reached(const Primitive& primitive) const
{
    const auto found = reached_.find(key_of(primitive));
    return found == reached_.end() ? nullptr : &found->second;
}

QString PrimitiveBook::reached_text() const
{
    std::map<std::string, ReachedFrom> known;
    for (std::size_t i = 0; i < list().size(); ++i)
        if (const ReachedFrom* from = reached(list()[i])) known[key_of(list()[i])] = *from;
    return known.empty() ? QString() : text_of(known);
}

void PrimitiveBook::take_reached(const QString& text) { reached_ = reached_of(text); }

std::shared_ptr<const PointSet> PrimitiveBook::points_of(const Primitive& primitive) const
{
    const auto found = points_.find(key_of(primitive));
    const SceneLayer* layer = layer_of(primitive);
    const auto tree = layer ? layer->drawn() : std::nullopt;
    if (found == points_.end() || !tree || !found->second->belongs_to(*tree->cloud->tree())) return nullptr;
    return found->second;
}

void PrimitiveBook::show()
{
    std::vector<Annotation> drawn;
    placements_.clear();
    std::size_t shown = 0;
    for (std::size_t i = 0; i < list().size(); ++i) shown += !list()[i].hidden;
    for (std::size_t i = 0; i < list().size(); ++i) {
        const Primitive& primitive = list()[i];
        const auto [place, is_new] = placements_.try_emplace(primitive.cloud);
        if (is_new) place->second = placement_of(primitive);
        if (primitive.hidden) continue;
        const bool is_selected = selected() == i;
        const bool labelled = is_selected || shown <= most_labels;
        for (Annotation& line : drawn_primitive(
                 primitive, place->second,
                 {colour_of(primitive), is_selected, labelled ? QString::fromStdString(primitive.name) : QString()}))
            drawn.push_back(std::move(line));
    }
    scene_.part<Annotations>().set(owner, std::move(drawn));
    // Views follow matrices; a program without events has none.
    list().empty() || !QCoreApplication::instance() ? timer_.stop() : timer_.start();
    emit changed();
}

void PrimitiveBook::follow_matrices()
{
    for (std::size_t i = 0; i < list().size(); ++i) {
        const auto drawn = placements_.find(list()[i].cloud);
        if (drawn == placements_.end() || !same_map(drawn->second, placement_of(list()[i]))) return show();
    }
}

void keep_primitives_in_projects()
{
    static bool once = false;
    if (std::exchange(once, true)) return;
    add_project_part({list_element,
                      [](Scene& scene) {
                          const PrimitiveList& list = scene.part<PrimitiveBook>().list();
                          return list.empty() ? QString() : QString::fromStdString(json_of(list.all()));
                      },
                      [](Scene& scene, const QString& text) {
                          PrimitiveList list;
                          list.add_all(parse_primitives(text.toStdString()));
                          list.forget_steps();  // undo does not take the opening of a project back
                          scene.part<PrimitiveBook>().replace(std::move(list));
                      }});
    add_project_part({reached_element, [](Scene& scene) { return scene.part<PrimitiveBook>().reached_text(); },
                      [](Scene& scene, const QString& text) { scene.part<PrimitiveBook>().take_reached(text); }});
}

}  // namespace pcm::host
