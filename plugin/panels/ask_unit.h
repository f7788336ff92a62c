// Asks for the project's unit of lengths, where the clouds state none. GUI thread.
#pragma once

#include "plugin/scene/scene.h"

#include <optional>
#include <string>

class QWidget;

namespace pcm::host {

// The chosen unit; asks the user unless that was done before. Nothing: the question was cancelled.
std::optional<std::string> ask_unit(Scene& scene, QWidget* parent);

}  // namespace pcm::host
