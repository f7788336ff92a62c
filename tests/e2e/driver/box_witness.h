// Sees the boxes of text that MeshLab is about to draw into a view: MeshLab forgets them when it has drawn them.
#pragma once

#include <common/GLLogStream.h>
#include <common/interfaces.h>

class BoxWitness : public QObject, public MeshDecorateInterface {
    Q_OBJECT
    Q_INTERFACES(MeshDecorateInterface)

public:
    QString pluginName() const override { return "BoxWitness"; }
    QString decorationName(FilterIDType) const override { return "Box witness"; }
    QString decorationInfo(FilterIDType) const override { return {}; }
    int getDecorationClass(QAction*) const override { return PerDocument; }
    bool startDecorate(QAction*, MeshDocument&, const RichParameterList*, GLArea*) override { return true; }
    void decorateMesh(QAction*, MeshModel&, const RichParameterList*, GLArea*, QPainter*, GLLogStream&) override {}
    // The decorators of documents are called last.
    void decorateDoc(QAction*, MeshDocument&, const RichParameterList*, GLArea*, QPainter*, GLLogStream& log) override
    {
        boxes = log.realTimeLogMultiMap();
    }

    QMultiMap<QString, QPair<QString, QString>> boxes;  // title; layer and text
};
