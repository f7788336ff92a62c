// Makes the real thing of what MeshLab's tools did to the sample of a tree, where it can be, and says in the view where
// it cannot.
//
// A frozen matrix becomes the layer's matrix again, which moves all of the cloud. Deleted vertices become a deletion of
// the cloud's points after a question. Anything else is named in red until the sample is restored. GUI thread.
#pragma once

#include "plugin/scene/scene_view.h"

#include <QString>

class QPainter;

namespace pcm::host {

// In a paint event with this camera, before the layer is drawn: looks at the sample of the tree that the layer shows.
// After the event a change is settled, once. About 0.3 ms.
void look_at_sample(SceneLayer& layer, const pcm::Camera& view);

// What is wrong with the layer's sample, as found by the last look; empty if nothing is.
QString sample_notice(const SceneLayer& layer);

// Writes the notices of the layers that this view shows into the view, in red.
void draw_sample_notices(const SceneView& view, QPainter& painter);

}  // namespace pcm::host
