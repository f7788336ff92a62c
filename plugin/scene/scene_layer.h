// A layer of the scene, as tools and panels see it. The program that shows the scene implements it.
#pragma once

#include "pcm/cloud/affine.h"
#include "pcm/cloud/geometry.h"
#include "pcm/cloud/metadata.h"
#include "plugin/scene/layer_cloud.h"

#include <QString>

#include <array>
#include <functional>
#include <optional>
#include <vector>

namespace pcm::host {

class Scene;

// The matrix of a layer, as the program keeps it: rows, in single precision. It moves coordinates of the views, which
// are source coordinates minus the scene's origin (layer_matrix.h has the map of source coordinates).
using LayerMatrix = std::array<std::array<float, 4>, 4>;
inline constexpr LayerMatrix identity_matrix{{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}, {0, 0, 0, 1}}};

// Owned by the scene, and valid until the scene signals that the layer was removed. GUI thread.
class SceneLayer {
public:
    virtual ~SceneLayer() = default;
    SceneLayer(const SceneLayer&) = delete;
    SceneLayer& operator=(const SceneLayer&) = delete;

    virtual Scene& scene() const = 0;
    virtual int id() const = 0;  // no other layer of the scene has it, later ones included
    virtual QString label() const = 0;
    virtual QString file() const = 0;  // the path that it was opened from; empty: none
    virtual void set_file(const QString& path) = 0;

    virtual bool is_visible() const = 0;
    virtual void show(bool on) = 0;  // or hides it, in all views of the scene

    virtual LayerMatrix matrix() const = 0;
    virtual void set_matrix(const LayerMatrix& matrix) = 0;
    virtual void mark_modified() = 0;

    // The tree that the layer shows; nothing for an ordinary layer.
    virtual std::optional<LayerCloud> tree() const = 0;
    // What views draw as a point cloud: the tree, or the drawn copy of an ordinary layer.
    virtual std::optional<LayerCloud> drawn() const = 0;
    // The map of source coordinates to the scene's, for what drawn() has. A matrix that was applied to the sample of
    // the tree, and has not been put back, counts too. Nothing where the cloud is at its place, and without a cloud.
    virtual std::optional<Affine> placement() const = 0;
    // What the file of the layer's points states; null: it has none. Valid until the layer changes.
    virtual const std::vector<Metadata>* metadata() const = 0;
    // Around the vertices of an ordinary layer, in the views' coordinates before the matrix; empty without any.
    virtual Box3d vertex_box() const = 0;
    // Calls `visit` with each vertex, of the sample where the layer shows a tree: its position in the views'
    // coordinates before the matrix, and whether the program's own tools have selected it.
    virtual void visit_vertices(const std::function<void(const Vec3d& position, bool is_selected)>& visit) const = 0;

protected:
    SceneLayer() = default;
};

}  // namespace pcm::host
