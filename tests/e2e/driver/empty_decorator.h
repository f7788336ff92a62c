// A decorator that draws nothing. MeshLab since 2021.05 loads no plugin but those of its own kinds, and this is the
// simplest.
#pragma once

#include "plugin/meshlab/plugin_bases.h"

#include <string>
#include <utility>

class EmptyDecorator : public pcm::host::DecorateBase {
public:
    // Newer MeshLab asks it of what it loads: MESHLAB_PLUGIN_IID_EXPORTER defines it there.
    virtual std::pair<std::string, bool> getMLVersion() const { return {}; }
    QString pluginName() const override { return "PcmTestDriver"; }
    QString decorationName(int) const override { return "Test driver"; }
    QString decorationInfo(int) const override { return {}; }
    int getDecorationClass(PluginAction*) const override { return PerDocument; }
    void initGlobalParameterList(PluginAction*, RichParameterList&) override {}
    void decorateMesh(PluginAction*, MeshModel&, const RichParameterList*, GLArea*, QPainter*, GLLogStream&) override {}
    void decorateDoc(PluginAction*, MeshDocument&, const RichParameterList*, GLArea*, QPainter*, GLLogStream&) override
    {
    }
};
