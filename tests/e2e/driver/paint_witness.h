// Sees what MeshLab paints into a view, at the end of each paint event: the boxes of text that it is about to draw,
// which it forgets afterwards, and the layers whose vertices it has drawn.
#pragma once

#include "tests/e2e/driver/empty_decorator.h"

#include <QPointer>

class PaintWitness : public QObject, public EmptyDecorator {
    Q_OBJECT
    Q_INTERFACES(PCM_DECORATE_INTERFACE)

public:
    explicit PaintWitness(GLArea* area) : area_(area), action_("Paint witness", this)
    {
        area_->iPerDocDecoratorlist << &action_;
    }
    ~PaintWitness() override
    {
        if (area_) area_->iPerDocDecoratorlist.removeAll(&action_);
    }

    bool startDecorate(PluginAction*, MeshDocument&, const RichParameterList*, GLArea*) override { return true; }
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
    QPointer<GLArea> area_;
    QAction action_;
};
