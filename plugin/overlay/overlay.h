// What a view says about the clouds in its picture: the text of MeshLab's box "Point Cloud", one for all layers.
#pragma once

#include "pcm/gl/draw/renderer.h"

#include <QString>

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace pcm::host {

// How full a cache is, and how often it had what was asked for.
struct CacheUse {
    std::string name;
    std::uint64_t used_bytes = 0, capacity_bytes = 0;
    std::uint64_t hits = 0, misses = 0;
};

struct Clipped {
    double expected = 0;
    bool exact = false;
};

// A cloud in the picture. FrameReport::clouds has the same order.
struct OverlayCloud {
    QString layer;  // its label
    std::uint64_t points = 0;
    std::uint64_t selected = 0;  // points
    bool clipped = false;        // a clip box is on
    // How many points it hides, as far as the tree's index says; absent while the box is being moved.
    std::optional<Clipped> hidden_by_clip;
};

// Shown only on request.
struct OverlayDetails {
    double target_spacing_px = 0;
    std::vector<CacheUse> caches;
};

// The drawn points and all of them in one unit: "1,234 of 56,789 points", "2.0 of 20 M points".
std::string amount_text(std::uint64_t drawn, std::uint64_t all);

// HTML as MeshLab's boxes take it, without tables: lines separated by <br>. How much is shown, then what the clouds
// lack and why points cannot be loaded, each sentence once, then the details. Empty if no cloud is in the picture.
QString overlay_text(const FrameReport& report, const std::vector<OverlayCloud>& clouds, const OverlayDetails* details);

}  // namespace pcm::host
