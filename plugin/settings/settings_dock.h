// The panel "Point Cloud" of MeshLab's window: all settings of the drawing, those that matter first. A change applies
// at once, in all views. MeshLab's own panel has our settings far below, in small print, and its tab of points does
// nothing for a tree.
#pragma once

#include "plugin/scene/scene_view.h"
#include "plugin/settings/setting_editor.h"

#include <QDockWidget>

#include <memory>
#include <vector>

class QMainWindow;

namespace pcm::host {

class Dock : public QDockWidget {
    Q_OBJECT

public:
    // Makes the panel when the first tree is shown in the window of `view`. The entry "Point Cloud" in MeshLab's menu
    // View hides and shows it. Whether it is hidden is kept for MeshLab's next start.
    static void show_for(const SceneView& view);

public slots:
    // Shows the values that MeshLab has.
    void refresh();

protected:
    void closeEvent(QCloseEvent* event) override;

private:
    Dock(QMainWindow* window, std::unique_ptr<SettingStore> settings);
    QWidget* make_form();
    void apply(const QString& name, const QVariant& value);
    void redraw();
    void store();
    void reset();

    const std::unique_ptr<SettingStore> settings_;
    Parameters defaults_;
    std::vector<std::unique_ptr<SettingEditor>> editors_;
    bool panel_is_old_ = false;  // MeshLab's
};

}  // namespace pcm::host
