// Sees what MeshLab paints into a view, at the end of each paint event: the boxes of text that it is about to draw,
// which it forgets afterwards, and the layers whose vertices it has drawn.
#pragma once

#include "plugin/meshlab/plugin_bases.h"

class PaintWitness : public QObject, public pcm::host::DecorateBase {
    Q_OBJECT
    Q_INTERFACES(PCM_DECORATE_INTERFACE)

public:
    explicit PaintWitness(GLArea* area) : area_(area), action_("Paint witness", this)
    {
        area_->iPerDocDecoratorlist << &action_;
    }
    ~PaintWitness() override { area_->iPerDocDecoratorlist.removeAll(&action_); }

    QString pluginName() const override { return "PaintWitness"; }
    QString decorationName(int) const override { return "Paint witness"; }
    QString decorationInfo(int) const override { return {}; }
    void initGlobalParameterList(PluginAction*, RichParameterList&) override {}
    int getDecorationClass(PluginAction*) const override { return PerDocument; }
    bool startDecorate(PluginAction*, MeshDocument&, const RichParameterList*, GLArea*) override { return true; }
    void decorateMesh(PluginAction*, MeshModel&, const RichParameterList*, GLArea*, QPainter*, GLLogStream&) override {}
    // The decorators of documents are called last.
    void decorateDoc(PluginAction*, MeshDocument& document, const RichParameterList*, GLArea*, QPainter*,
                     GLLogStream& log) override
    {
        boxes = log.realTimeLogMultiMap();
        if (document.isBusy()) return;  // MeshLab has drawn the background only
        bool native = false;
        const std::vector<MeshModel*> layers = pcm::host::models_of(document);
        for (const MeshModel* layer : layers) {
            MLRenderingData data;
            area_->mvc()->sharedDataContext()->getRenderInfoPerMeshView(layer->id(), area_->context(), data);
            native |= layer->cm.vn > 0 && data.isPrimitiveActive(MLRenderingData::PR_POINTS);
        }
        paints += !layers.empty();
        native_paints += native;
    }

    QMultiMap<QString, QPair<QString, QString>> boxes;  // title; layer and text
    int paints = 0;                                     // with layers
    int native_paints = 0;                              // with vertices of layers

private:
    GLArea* area_;
    QAction action_;
};
