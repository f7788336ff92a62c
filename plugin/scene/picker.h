// Picks points of the clouds that a view shows. GUI thread; the search runs on a thread of its own, so that the view is
// not blocked.
#pragma once

#include "pcm/cloud/geometry.h"
#include "pcm/tree/tree.h"
#include "plugin/scene/scene_view.h"

#include <QObject>
#include <QPoint>
#include <QString>

#include <array>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace pcm::host {

struct PickedValue {
    std::string name, value;  // value in the attribute's own unit, with all digits
};

struct Picked {
    int layer_id = -1;                  // identifier of the layer
    std::shared_ptr<PointCloud> cloud;  // the cloud that the layer shows
    NodeId node = no_node;              // node of the tree
    std::uint32_t point = 0;            // its number in the node's chunk
    Vec3d position{};                   // source coordinates, as the file has them
    // The same with all digits (pick/describe_point.h); empty while the answer is not final.
    std::array<std::string, 3> position_text;
    Vec3d shown_at{};    // where the view shows it: `position` moved by the layer's matrix; coordinates of the scene
    double spacing = 0;  // about the distance to its neighbours, source units; 0: not known
    // The same of several points around it (query/local_spacing.h): for defaults, which one point's may mislead. 0: not
    // known, as while the answer is not final.
    double spacing_around = 0;
    double scale = 1;      // scale of the layer's matrix: a length in the scene for a length of 1 in the cloud
    double grid_step = 0;  // the largest step of the grid that positions are on, source units
    std::vector<PickedValue> attributes;  // all of them; none while the answer is not final
};

struct PickAnswer {
    std::optional<Picked> point;
    QString message;    // why there is no point: "No point within 4 pixels of the cursor"
    bool final = true;  // false: found among the chunks in memory, and being confirmed on all of them
};

// Finds the nearest visible point under `place` (Qt's pixels in the view), as pick/point_picker.h defines it. What
// counts is the view's last picture: its camera, the layers that are drawn in it with their matrices, hidden classes
// and conditions, and the clip box. Faces of MeshLab's other layers hide points exactly
// (meshlab/mesh_occlusion.h).
//
// `answer` is called in the GUI thread, after pick() has returned: as soon as possible with what is in memory, if there
// is a point there (final == false), then once with the exact answer. It is not called after `context` or the view is
// destroyed, nor for a pick that a later one of the same context has replaced.
void pick(SceneView& view, const QPoint& place, QObject& context, const std::function<void(const PickAnswer&)>& answer);

}  // namespace pcm::host
