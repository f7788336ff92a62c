// Writes legends into a picture, in its upper right corner.
#pragma once

#include "pcm/gl/draw/legend.h"
#include "pcm/offscreen/image.h"

#include <vector>

namespace pcm::cli {

// One below the other, on a half transparent dark ground, as large as the picture's height suggests; what does not fit
// is cut. Colours of the image are not multiplied by alpha. Letters are ASCII; others become '?'.
void draw_legends(Image& image, const std::vector<Legend>& legends);

}  // namespace pcm::cli
