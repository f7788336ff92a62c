// The true picture of a scene's view, by rays.
#pragma once

#include "bench/pictures/scenes/look.h"

#include "pcm/offscreen/image.h"
#include "pcm/view/camera_path.h"

namespace pcm::bench {

struct TruePicture {
    Image colours;  // means over 5 x 5 rays a pixel; alpha is the share of them that hit something
    Image labels;   // from the ray through the pixel's middle: the thing's colour, or transparent
    // From the same ray: red is its Kind, or 0 for the sky; green is 255 where three rays of the pixel saw what a
    // scanner has seen (or the sky), else 0: what no scanner saw no picture of its points can show.
    Image facts;
};

// A perspective frame, relative to the scene's corner. The same for any number of threads.
TruePicture true_picture(const Eye& eye, const CameraFrame& frame, int width, int height, unsigned threads);

}  // namespace pcm::bench
