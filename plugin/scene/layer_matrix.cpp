#include "plugin/scene/layer_matrix.h"

#include "pcm/system/error.h"
#include "pcm/system/tree_folder.h"
#include "plugin/scene/annotations.h"

#include <cmath>

namespace pcm::host {

namespace {

bool is_finite(const LayerMatrix& matrix)
{
    for (const auto& row : matrix)
        for (const float number : row)
            if (!std::isfinite(number)) return false;
    return true;
}

void refuse_if_locked(bool locked, const SceneLayer& layer)
{
    if (locked)
        throw Error(ErrorCode::invalid_argument, {}, "the layer '" + layer.label().toStdString() + "' is locked",
                    "unlock it in the panel Point Clouds");
}

}  // namespace

LayerMatrix matrix_of(const Affine& map, const Vec3d& origin)
{
    LayerMatrix matrix = identity_matrix;
    const Vec3d shift = map(origin) - origin;
    for (std::size_t r = 0; r < 3; ++r) {
        for (std::size_t c = 0; c < 3; ++c) matrix[r][c] = static_cast<float>(map.linear[r][c]);
        matrix[r][3] = static_cast<float>(shift[r]);
    }
    return matrix;
}

Affine map_of(const LayerMatrix& matrix, const Vec3d& origin)
{
    Affine map;
    map.pivot = origin;
    for (std::size_t r = 0; r < 3; ++r) {
        for (std::size_t c = 0; c < 3; ++c) map.linear[r][c] = double(matrix[r][c]);
        map.target[r] = origin[r] + double(matrix[r][3]);
    }
    return map;
}

Affine after(const Affine& outer, const Affine& inner)
{
    Affine both;
    for (std::size_t r = 0; r < 3; ++r)
        for (std::size_t c = 0; c < 3; ++c) {
            both.linear[r][c] = 0;
            for (std::size_t k = 0; k < 3; ++k) both.linear[r][c] += outer.linear[r][k] * inner.linear[k][c];
        }
    both.pivot = inner.pivot;
    both.target = outer(inner.target);
    return both;
}

double matrix_rounding(const Affine& map, const Vec3d& origin, const Box3d& box)
{
    const LayerMatrix matrix = matrix_of(map, origin);
    const Vec3d shift = map(origin) - origin;
    double largest = 0;
    for (unsigned corner = 0; corner < 8 && !box.empty(); ++corner) {
        Vec3d p, apart;
        for (std::size_t a = 0; a < 3; ++a) p[a] = (corner >> a & 1u ? box.max[a] : box.min[a]) - origin[a];
        for (std::size_t r = 0; r < 3; ++r) {
            double d = double(matrix[r][3]) - shift[r];
            for (std::size_t c = 0; c < 3; ++c) d += (double(matrix[r][c]) - map.linear[r][c]) * p[c];
            apart[r] = d;
        }
        largest = std::max(largest, length(apart));
    }
    return largest;
}

LayerMatrices::LayerMatrices(Scene& scene) : QObject(&scene), scene_(scene)
{
    connect(&scene, &Scene::layer_removed, this, [this](int layer_id) {
        histories_.erase(layer_id);
        locked_.erase(layer_id);
    });
}

void LayerMatrices::put(SceneLayer& layer, const LayerMatrix& matrix)
{
    layer.set_matrix(matrix);
    layer.mark_modified();
    scene_.repaint();
    emit changed(layer.id());
}

void LayerMatrices::set(SceneLayer& layer, const LayerMatrix& matrix, const QString& words)
{
    refuse_if_locked(is_locked(layer), layer);
    if (!is_finite(matrix))
        throw Error(ErrorCode::invalid_argument, {}, "the matrix has a number that is not finite, or too large");
    History& history = histories_[layer.id()];
    history.steps.resize(history.done);
    history.steps.push_back({layer.matrix(), matrix, words});
    history.done = history.steps.size();
    put(layer, matrix);
}

QString LayerMatrices::undo_words(const SceneLayer& layer) const
{
    const auto found = histories_.find(layer.id());
    return found == histories_.end() || found->second.done == 0 ? QString()
                                                                : found->second.steps[found->second.done - 1].words;
}

QString LayerMatrices::redo_words(const SceneLayer& layer) const
{
    const auto found = histories_.find(layer.id());
    return found == histories_.end() || found->second.done == found->second.steps.size()
               ? QString()
               : found->second.steps[found->second.done].words;
}

void LayerMatrices::undo(SceneLayer& layer)
{
    if (undo_words(layer).isEmpty()) return;
    refuse_if_locked(is_locked(layer), layer);
    History& history = histories_[layer.id()];
    put(layer, history.steps[--history.done].before);
}

void LayerMatrices::redo(SceneLayer& layer)
{
    if (redo_words(layer).isEmpty()) return;
    refuse_if_locked(is_locked(layer), layer);
    History& history = histories_[layer.id()];
    put(layer, history.steps[history.done++].after);
}

bool LayerMatrices::is_locked(const SceneLayer& layer) const { return locked_.count(layer.id()) != 0; }

void LayerMatrices::lock(SceneLayer& layer, bool on)
{
    if (on)
        locked_[layer.id()] = layer.matrix();
    else
        locked_.erase(layer.id());
    emit changed(layer.id());
}

bool LayerMatrices::hold(SceneLayer& layer)
{
    const auto found = locked_.find(layer.id());
    if (found == locked_.end() || layer.matrix() == found->second) return false;
    layer.set_matrix(found->second);
    scene_.log(LogLevel::warning, "The layer '" + layer.label() +
                                      "' is locked: its matrix is what it was. Unlock it in the panel Point Clouds.");
    return true;
}

void refuse_locked(Scene& scene, const std::filesystem::path& tree)
{
    for (const SceneLayer* layer : scene.layers()) {
        if (!layer || !scene.part<LayerMatrices>().is_locked(*layer)) continue;
        const auto shown = layer->tree();
        if (shown && (shown->cloud->tree()->folder() == tree || same_tree_folder(shown->cloud->tree()->folder(), tree)))
            throw Error(ErrorCode::invalid_argument, tree,
                        "the layer '" + layer->label().toStdString() + "' shows this tree and is locked",
                        "unlock it in the panel Point Clouds, or write a copy");
    }
}

}  // namespace pcm::host
