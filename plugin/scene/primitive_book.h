// The shapes that were fitted to the clouds of a scene. Views show them whichever tool is active, filters and tools
// add to them, and project files keep them. GUI thread.
//
// They are in the source coordinates of their clouds. Views show them where the matrix of the layer puts the cloud.
#pragma once

#include "pcm/cloud/affine.h"
#include "pcm/place/reached_from.h"
#include "pcm/query/point_set.h"
#include "pcm/shapes/primitive_list.h"
#include "plugin/scene/list_book.h"

#include <QTimer>

#include <cstddef>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace pcm::host {

// What Primitive::cloud is for the cloud of a layer: the folder of its tree, or the label of an ordinary layer.
std::string cloud_name(const SceneLayer& layer);

class PrimitiveBook : public ListBook<PrimitiveList> {
    Q_OBJECT

public:
    explicit PrimitiveBook(Scene& scene);

    // The layer that shows the primitive's cloud; null: none does.
    SceneLayer* layer_of(const Primitive& primitive) const;
    std::optional<Affine> placement_of(const Primitive& primitive) const;

    // The list where the matrices of layers put it, as clouds are exported; hidden ones only on request. Throws
    // Error(invalid_argument), naming primitive and layer, where a matrix is not rigid.
    std::vector<Primitive> placed(bool hidden_too) const;

    // The points that belong to a primitive, as they were found; null where that is not known: a project was opened, or
    // the cloud has changed.
    void keep_points(const Primitive& primitive, std::shared_ptr<const PointSet> points,
                     std::optional<ReachedFrom> reached = {});
    std::shared_ptr<const PointSet> points_of(const Primitive& primitive) const;
    // How they are found again, which projects keep; null: that is not known.
    const ReachedFrom* reached(const Primitive& primitive) const;
    // What was reached, for all primitives of the list for which it is known, as a text, and back: take_reached()
    // throws Error(bad_format).
    QString reached_text() const;
    void take_reached(const QString& text);

private:
    void show() override;
    void follow_matrices();
    bool is_drawn(const Tree& tree) const;

    std::map<std::string, std::shared_ptr<const PointSet>> points_;  // keyed by cloud and shape
    std::map<std::string, ReachedFrom> reached_;                     // likewise
    std::map<std::string, std::optional<Affine>> placements_;        // placements of the clouds, as drawn
    QTimer timer_;  // MeshLab does not say when it changes a layer's matrix
};

// Makes project files keep the primitives of documents, as the element PointCloudPrimitives. Once per program.
void keep_primitives_in_projects();

}  // namespace pcm::host
