// A clip box as the text that project files keep.
#pragma once

#include "plugin/scene/scene_state.h"

#include <QString>

#include <optional>

namespace pcm::host {

// JSON with all digits: centre, axes (of length 1, perpendicular), half sizes, source units.
QString text_of(const ClipBox& box);

// Throws Error(bad_format), saying what is wrong with the text.
ClipBox clip_box_of(const QString& text);

// Makes project files keep the clip boxes of documents, as the element PointCloudClipBox. Once per program.
void keep_clip_boxes_in_projects();

}  // namespace pcm::host
