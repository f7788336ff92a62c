#include "plugin/meshlab/render/render_plugin.h"

#include "plugin/meshlab/2021/whole/parts.h"

template class pcm::host::ListedPart<PointCloudDecorator, &PluginManager::decoratePlugins,
                                     &DecoratePluginContainer::pushDecoratePlugin,
                                     &DecoratePluginContainer::eraseDecoratePlugin>;
