// Views that draw discs, because a cloud has got radii and normals.
#pragma once

#include <common/interfaces.h>

namespace pcm::host {

// The views of the document draw discs in perspective from now on, unless they draw discs already; the panels show
// that, and the log says so. Clouds without normals are drawn as before. Does nothing without a window.
void draw_discs(MeshDocument& document);

}  // namespace pcm::host
