// Sees what MeshLab paints into a view, at the end of each paint event: the boxes of text that it is about to draw,
// which it forgets afterwards, and the layers whose vertices it has drawn.
#pragma once

#include <common/GLLogStream.h>
#include <common/interfaces.h>
#include <meshlab/glarea.h>

class PaintWitness : public QObject, public MeshDecorateInterface {
    Q_OBJECT
    Q_INTERFACES(MeshDecorateInterface)

public:
    explicit PaintWitness(GLArea* area) : area_(area), action_("Paint witness", this)
    {
        area_->iPerDocDecoratorlist << &action_;
    }
    ~PaintWitness() override { area_->iPerDocDecoratorlist.removeAll(&action_); }

    QString pluginName() const override { return "PaintWitness"; }
    QString decorationName(FilterIDType) const override { return "Paint witness"; }
    QString decorationInfo(FilterIDType) const override { return {}; }
    int getDecorationClass(QAction*) const override { return PerDocument; }
    bool startDecorate(QAction*, MeshDocument&, const RichParameterList*, GLArea*) override { return true; }
    void decorateMesh(QAction*, MeshModel&, const RichParameterList*, GLArea*, QPainter*, GLLogStream&) override {}
    // The decorators of documents are called last.
    void decorateDoc(QAction*, MeshDocument& document, const RichParameterList*, GLArea*, QPainter*,
                     GLLogStream& log) override
    {
        boxes = log.realTimeLogMultiMap();
        if (document.isBusy()) return;  // MeshLab has drawn the background only
        bool native = false;
        for (const MeshModel* layer : document.meshList) {
            MLRenderingData data;
            area_->mvc()->sharedDataContext()->getRenderInfoPerMeshView(layer->id(), area_->context(), data);
            native |= layer->cm.vn > 0 && data.isPrimitiveActive(MLRenderingData::PR_POINTS);
        }
        paints += !document.meshList.empty();
        native_paints += native;
    }

    QMultiMap<QString, QPair<QString, QString>> boxes;  // title; layer and text
    int paints = 0;                                     // with layers
    int native_paints = 0;                              // with vertices of layers

private:
    GLArea* area_;
    QAction action_;
};
