#include "plugin/meshlab/filter/filter_plugin.h"

#include "plugin/meshlab/2021/whole/parts.h"

template class pcm::host::ListedPart<PointCloudFilters, &PluginManager::filterPlugins,
                                     &FilterPluginContainer::pushFilterPlugin,
                                     &FilterPluginContainer::eraseFilterPlugin>;
