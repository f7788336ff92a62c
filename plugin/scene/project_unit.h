// The unit of a project's lengths as its user has chosen it: many clouds do not state a coordinate system. Asked for
// once, and kept in the project. GUI thread.
#pragma once

#include "plugin/scene/scene.h"

#include <QString>

#include <optional>
#include <string>

namespace pcm::host {

// "m", "ft", "ftUS", or empty where the user does not know it; nothing before the user was asked.
std::optional<std::string> chosen_unit(const Scene& scene);
void choose_unit(Scene& scene, const std::string& symbol);

// The user's words for the symbols; the last one is the empty symbol.
struct UnitChoice {
    const char* symbol;
    const char* words;
};
constexpr UnitChoice unit_choices[] = {
    {"m", "metres"}, {"ft", "feet"}, {"ftUS", "US survey feet"}, {"", "another unit, or not known"}};

// Makes project files keep it, as the element PointCloudLengthUnit. Once per program.
void keep_units_in_projects();

}  // namespace pcm::host
