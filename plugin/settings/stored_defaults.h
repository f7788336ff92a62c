// MeshLab stores the default of every setting at its first start, as if the user had chosen it: a default that changes
// with a later version would never be seen. So the defaults are recorded, and a stored value that is no more than a
// former default gives way to the new one.
#pragma once

#include "plugin/scene/setting_store.h"

namespace pcm::host {

// Called with the defaults of this version before MeshLab reads its stored settings. Does its work once in a process.
void follow_new_defaults(const Parameters& defaults, SettingStore& settings);

// The user keeps the stored value of this setting, whatever the defaults become.
void keep_stored(const QString& name);

}  // namespace pcm::host
