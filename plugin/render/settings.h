// Settings of the drawing of point clouds, as MeshLab's parameters.
#pragma once

#include "pcm/gl/renderer.h"
#include "pcm/gl/splat_style.h"
#include "plugin/render/colour_settings.h"

#include <common/interfaces.h>

namespace pcm::host {

struct Settings {
    RenderOptions render;
    CloudStyle style;
    ColourSettings colour;
    std::uint64_t l1_bytes = 0;
    std::uint64_t l2_bytes = 0;
};

void add_settings(RichParameterList& parameters);

// A value out of its range is replaced with the nearest valid one.
Settings read_settings(const RichParameterList& parameters);

}  // namespace pcm::host
