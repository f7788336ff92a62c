#include "plugin/render/disc_choice.h"

#include "plugin/host/registry.h"
#include "plugin/render/dock.h"
#include "plugin/render/settings.h"

#include <meshlab/glarea.h>

#include <QMainWindow>

namespace pcm::host {

void draw_discs(MeshDocument& document)
{
    for (GLArea* area : views_of(document)) {
        // All views of a window share the parameters.
        auto& parameters = const_cast<RichParameterList&>(*area->glas.currentGlobalParamSet);
        if (!choose_discs(parameters)) continue;
        document.Log.Log(GLLogStream::SYSTEM,
                         "Point Cloud: the cloud has radii and normals now, and the view draws discs, perspective "
                         "accurate. The setting Splats of the panel Point Cloud changes that.");
        if (QMainWindow* window = window_of(*area)) {
            if (Dock* dock = window->findChild<Dock*>()) QMetaObject::invokeMethod(dock, "refresh");
            QMetaObject::invokeMethod(window, "updateLayerDialog", Qt::QueuedConnection);
        }
    }
    for (GLArea* area : views_of(document)) area->update();
}

}  // namespace pcm::host
