// The window of a profile: its plot, and buttons. GUI thread.
#pragma once

#include "plugin/tools/measure/profile_data.h"

#include <QWidget>

#include <memory>

class QLabel;

namespace pcm::host {

class ProfileWindow : public QWidget {
    Q_OBJECT

public:
    // A window in addition to that of `parent`, which owns it; closing it deletes it.
    ProfileWindow(QWidget* parent, std::shared_ptr<const ProfileData> data);

    const ProfileData& data() const { return *data_; }
    ProfilePlot& plot() { return *plot_; }
    void say(const QString& text);  // below the plot
    // Saves what the plot shows. Throws Error(io) where that fails.
    void save_picture(const QString& file) const;

signals:
    // The points are to be written to a file of this kind: "csv" or "dxf".
    void wanted(const QString& extension);

private:
    void ask_for_picture();

    std::shared_ptr<const ProfileData> data_;
    ProfilePlot* plot_;
    QLabel* place_;
};

}  // namespace pcm::host
