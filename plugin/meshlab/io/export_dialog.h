// Exporting a layer that shows a tree from MeshLab's menu File. MeshLab proposes the name of the layer's file,
// NAME.pct, whose type nothing writes, and Export Mesh refuses it. For such a layer both entries open a dialog of ours,
// which proposes a file next to the tree in a format that can be written; MeshLab then exports to the chosen file.
// Other layers are exported as MeshLab does.
#pragma once

#include "plugin/scene/scene_view.h"

#include <QObject>

#include <filesystem>

class QMainWindow;

namespace pcm::host {

// A file next to `tree` that does not exist yet: city.laz for city.pct, city-export.laz if city.laz exists, then
// city-export-2.laz ...
std::filesystem::path proposed_export(const std::filesystem::path& tree);

class ExportDialog : public QObject {
    Q_OBJECT

public:
    // Takes over the two entries of the window around the view. Called as often as one likes.
    static void take_over(const SceneView& view);

private:
    ExportDialog(QMainWindow* window);
    void take(const char* text, const char* slot);
    void export_current(const char* slot);

    QMainWindow* window_;
};

// In MeshLab's dialog about what is to be saved, which is shown afterwards: hides what our export of this layer does
// not read. For a tree everything is written, whatever is ticked; for vertices, these members (export.h:
// export_mask()). Does nothing where there is no window.
void hide_unread_ticks(const SceneLayer& layer);

// MeshLab makes the written file the file of the layer, and would reload it and name it in projects. The layer of a
// tree keeps its own. Called before MeshLab does so.
void keep_file_of(SceneLayer& layer);

}  // namespace pcm::host
