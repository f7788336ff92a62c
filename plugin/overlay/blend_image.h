// Draws images of texts over a view.
#pragma once

#include <QImage>

namespace pcm::host {

// Blends an image (QImage::Format_RGBA8888, not premultiplied) into the current framebuffer of a compatibility context,
// over what is there; depth is neither tested nor written. Its lower left corner is `x`, `y` pixels of the screen from
// the window's; what lies outside is cut off. Leaves the GL state as it was.
void blend_image(const QImage& image, int x, int y);

}  // namespace pcm::host
