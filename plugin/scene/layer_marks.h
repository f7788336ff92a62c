// Which layers of a document are locked and which are shown alone, as projects keep it. GUI thread.
#pragma once

#include "plugin/scene/scene.h"

#include <QString>

namespace pcm::host {

// As JSON; empty where no layer is either. Layers that are hidden because others are shown alone are marked as such.
QString layer_marks(Scene& scene);

// Locks layers and shows them alone as the text says, once the document is not busy any more: while a project is
// opened, layers get their matrices one after another. A layer is recognised by the name of its file, several with
// the same name by their order. Throws Error(bad_format) for any other text; the document keeps what it
// has.
void take_layer_marks(Scene& scene, const QString& text);

// Lets project files keep them. Called once.
void keep_layer_marks_in_projects();

}  // namespace pcm::host
