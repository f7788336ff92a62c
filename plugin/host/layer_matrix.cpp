#include "plugin/host/layer_matrix.h"

#include "pcm/system/error.h"
#include "plugin/host/annotations.h"

#include <cmath>

namespace pcm::host {

namespace {

bool is_finite(const Matrix44m& matrix)
{
    for (int i = 0; i < 16; ++i)
        if (!std::isfinite(matrix.V()[i])) return false;
    return true;
}

void refuse_if_locked(bool locked, const MeshModel& layer)
{
    if (locked)
        throw Error(ErrorCode::invalid_argument, {}, "the layer '" + layer.label().toStdString() + "' is locked",
                    "unlock it in the panel Point Clouds");
}

}  // namespace

Matrix44m matrix_of(const Affine& map, const Vec3d& origin)
{
    Matrix44m matrix = Matrix44m::Identity();
    const Vec3d shift = map(origin) - origin;
    for (int r = 0; r < 3; ++r) {
        for (int c = 0; c < 3; ++c) matrix[r][c] = static_cast<Scalarm>(map.linear[std::size_t(r)][std::size_t(c)]);
        matrix[r][3] = static_cast<Scalarm>(shift[std::size_t(r)]);
    }
    return matrix;
}

Affine map_of(const Matrix44m& matrix, const Vec3d& origin)
{
    Affine map;
    map.pivot = origin;
    for (int r = 0; r < 3; ++r) {
        for (int c = 0; c < 3; ++c) map.linear[std::size_t(r)][std::size_t(c)] = double(matrix[r][c]);
        map.target[std::size_t(r)] = origin[std::size_t(r)] + double(matrix[r][3]);
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
    const Matrix44m matrix = matrix_of(map, origin);
    const Vec3d shift = map(origin) - origin;
    double largest = 0;
    for (unsigned corner = 0; corner < 8 && !box.empty(); ++corner) {
        Vec3d p, apart;
        for (std::size_t a = 0; a < 3; ++a) p[a] = (corner >> a & 1u ? box.max[a] : box.min[a]) - origin[a];
        for (int r = 0; r < 3; ++r) {
            double d = double(matrix[r][3]) - shift[std::size_t(r)];
            for (int c = 0; c < 3; ++c)
                d += (double(matrix[r][c]) - map.linear[std::size_t(r)][std::size_t(c)]) * p[std::size_t(c)];
            apart[std::size_t(r)] = d;
        }
        largest = std::max(largest, length(apart));
    }
    return largest;
}

LayerMatrices::LayerMatrices(MeshDocument& document) : QObject(&document), document_(document)
{
    connect(&document, &MeshDocument::meshRemoved, this, [this](int mesh_id) {
        histories_.erase(mesh_id);
        locked_.erase(mesh_id);
    });
}

LayerMatrices& LayerMatrices::of(MeshDocument& document)
{
    auto* found = document.findChild<LayerMatrices*>(QString(), Qt::FindDirectChildrenOnly);
    return found ? *found : *new LayerMatrices(document);
}

void LayerMatrices::put(MeshModel& layer, const Matrix44m& matrix)
{
    layer.cm.Tr = matrix;
    layer.setMeshModified(true);
    repaint_views(document_);
    emit changed(layer.id());
}

void LayerMatrices::set(MeshModel& layer, const Matrix44m& matrix, const QString& words)
{
    refuse_if_locked(is_locked(layer), layer);
    if (!is_finite(matrix))
        throw Error(ErrorCode::invalid_argument, {}, "the matrix has a number that is not finite, or too large");
    History& history = histories_[layer.id()];
    history.steps.resize(history.done);
    history.steps.push_back({layer.cm.Tr, matrix, words});
    history.done = history.steps.size();
    put(layer, matrix);
}

QString LayerMatrices::undo_words(const MeshModel& layer) const
{
    const auto found = histories_.find(layer.id());
    return found == histories_.end() || found->second.done == 0 ? QString()
                                                                : found->second.steps[found->second.done - 1].words;
}

QString LayerMatrices::redo_words(const MeshModel& layer) const
{
    const auto found = histories_.find(layer.id());
    return found == histories_.end() || found->second.done == found->second.steps.size()
               ? QString()
               : found->second.steps[found->second.done].words;
}

void LayerMatrices::undo(MeshModel& layer)
{
    if (undo_words(layer).isEmpty()) return;
    refuse_if_locked(is_locked(layer), layer);
    History& history = histories_[layer.id()];
    put(layer, history.steps[--history.done].before);
}

void LayerMatrices::redo(MeshModel& layer)
{
    if (redo_words(layer).isEmpty()) return;
    refuse_if_locked(is_locked(layer), layer);
    History& history = histories_[layer.id()];
    put(layer, history.steps[history.done++].after);
}

bool LayerMatrices::is_locked(const MeshModel& layer) const { return locked_.count(layer.id()) != 0; }

void LayerMatrices::lock(MeshModel& layer, bool on)
{
    if (on)
        locked_[layer.id()] = layer.cm.Tr;
    else
        locked_.erase(layer.id());
    emit changed(layer.id());
}

bool LayerMatrices::hold(MeshModel& layer)
{
    const auto found = locked_.find(layer.id());
    if (found == locked_.end() || layer.cm.Tr == found->second) return false;
    layer.cm.Tr = found->second;
    document_.Log.Log(GLLogStream::WARNING,
                      qPrintable("The layer '" + layer.label() +
                                 "' is locked: its matrix is what it was. Unlock it in the panel Point Clouds."));
    return true;
}

void refuse_locked(MeshDocument& document, const std::filesystem::path& tree)
{
    for (const MeshModel* layer : document.meshList) {
        if (!layer || !LayerMatrices::of(document).is_locked(*layer)) continue;
        const auto shown = Registry::instance().find(*layer);
        std::error_code ignored;
        if (shown && (shown->cloud->tree()->folder() == tree ||
                      std::filesystem::equivalent(shown->cloud->tree()->folder(), tree, ignored)))
            throw Error(ErrorCode::invalid_argument, tree,
                        "the layer '" + layer->label().toStdString() + "' shows this tree and is locked",
                        "unlock it in the panel Point Clouds, or write a copy");
    }
}

}  // namespace pcm::host
