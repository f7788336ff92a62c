// Settings of the drawing of point clouds, as parameters.
#pragma once

#include "pcm/gl/draw/renderer.h"
#include "pcm/gl/style/splat_style.h"
#include "plugin/overlay/map_overlay.h"
#include "plugin/scene/parameters.h"
#include "plugin/settings/colour_settings.h"

#include <QColor>

#include <optional>

namespace pcm::host {

struct Settings {
    RenderOptions render;
    CloudStyle style;
    ColourSettings colour;
    std::uint64_t l1_bytes = 0;
    std::uint64_t l2_bytes = 0;
    bool details = false;  // in the text about the clouds
    bool oblique_first_view = true;
    MapSettings map;
    std::optional<QColor> background;  // instead of MeshLab's
};

// All settings, those that matter first.
void add_settings(Parameters& parameters);
// The first of them: what points are drawn as, their size and colour, lighting, background.
void add_first_settings(Parameters& parameters);
// Whether this is an amount of memory.
bool is_memory(const QString& name);
// Whether the number 0 switches this setting off.
bool zero_is_off(const QString& name);

// A value out of its range is replaced with the nearest valid one.
Settings read_settings(const Parameters& parameters);

}  // namespace pcm::host
