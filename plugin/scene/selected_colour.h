// The colour in which views show selected points: one of the user's settings, for all documents. GUI thread.
#pragma once

#include "plugin/scene/scene.h"

#include <QColor>

#include <optional>

namespace pcm::host {

// What the user has chosen; nothing: the renderer's own.
std::optional<QColor> chosen_selected_colour();

// What a user sees before choosing, as 8-bit numbers.
inline const QColor usual_selected_colour(255, 64, 13);

// Keeps it in the user's settings, and repaints the views of the scene.
void choose_selected_colour(const QColor& colour, const Scene& scene);

}  // namespace pcm::host
