// Parameters as MeshLab's lists of them, and back: where MeshLab asks for them, shows and stores them.
#pragma once

#include "plugin/scene/setting_store.h"

#include <memory>

class RichParameterList;

namespace pcm::host {

void add_to(RichParameterList& list, const Parameters& parameters);

// The parameters whose values are of a type that Parameter has and whose names begin so.
Parameters parameters_of(const RichParameterList& list, const char* beginning = "");

// What the names of our settings begin with, among MeshLab's.
inline constexpr const char* setting_prefix = "MeshLab::PointCloud::";

// MeshLab's settings, which live as long as its window. `list`: null where only stored settings matter.
std::unique_ptr<SettingStore> setting_store(RichParameterList* list);

}  // namespace pcm::host
