#include "plugin/meshlab/edit/edit_plugin.h"

#include "plugin/meshlab/2021/whole/parts.h"

template class pcm::host::ListedPart<PointCloudTools, &PluginManager::editPlugins, &EditPluginContainer::pushEditPlugin,
                                     &EditPluginContainer::eraseEditPlugin>;
