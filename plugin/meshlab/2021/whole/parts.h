// The plugins of the file that has all of them, but its importer. MeshLab makes one plugin of a file, and an object
// cannot be an edit plugin and another one at once: so the importer is what MeshLab loads, and puts the others into
// MeshLab's lists.
#pragma once

#include "plugin/meshlab/plugin_bases.h"

#include <memory>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

namespace pcm::host {

// In MeshLab's list while it exists.
class Part {
public:
    virtual ~Part() = default;
};

using MakePart = std::unique_ptr<Part> (*)();

// What make_parts() makes, of each part that is compiled into the file. For static objects.
bool add_part(MakePart make);
std::vector<std::unique_ptr<Part>> make_parts();

// PyMeshLab asks the plugin that it has loaded for functions, and no other: gives it those of these filters.
void tell_python(FilterPlugin& filters);

// MeshLab's window asks decorators for their settings when it starts: gives a running one what it lacks.
void tell_window(DecoratePlugin& decorator);

// What MESHLAB_PLUGIN_IID_EXPORTER gives the plugin of a file.
template <class Plugin>
class Versioned final : public Plugin {
public:
    std::pair<std::string, bool> getMLVersion() const final
    {
        return {meshlab::meshlabVersion(), meshlab::builtWithDoublePrecision()};
    }
};

// A part as a plugin in a list of MeshLab's. PluginManager keeps its lists private; an explicit instantiation may name
// them, and adds the part: `template class pcm::host::ListedPart<PLUGIN, &PluginManager::LIST, &LIST_CLASS::push,
// &LIST_CLASS::erase>;`
template <class Plugin, auto list, auto push, auto erase>
class ListedPart final : public Part {
public:
    ListedPart()
    {
        (meshlab::pluginManagerInstance().*list.*push)(&plugin_);
        if constexpr (std::is_base_of_v<FilterPlugin, Plugin>) tell_python(plugin_);
        if constexpr (std::is_base_of_v<DecoratePlugin, Plugin>) tell_window(plugin_);
    }
    ~ListedPart() override { (meshlab::pluginManagerInstance().*list.*erase)(&plugin_); }

private:
    static inline const bool added_ =
        add_part([]() -> std::unique_ptr<Part> { return std::make_unique<ListedPart>(); });

    Versioned<Plugin> plugin_;
};

}  // namespace pcm::host
