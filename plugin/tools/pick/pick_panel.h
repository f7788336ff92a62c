// The panel of the tool Pick Point: all that is known about a point.
#pragma once

#include "plugin/tools/pick/picked_text.h"

#include <QDockWidget>

#include <vector>

class QPushButton;
class QTableWidget;

namespace pcm::host {

class MessageArea;

class PickPanel : public QDockWidget {
    Q_OBJECT

public:
    explicit PickPanel(QWidget* window);
    // `complete`: false while the point is being confirmed.
    void show_point(const std::vector<PickedLine>& lines, bool complete);
    void say(const QString& text);

signals:
    void copy_asked();  // the button, or Ctrl+C in the panel

private:
    QTableWidget* table_;
    MessageArea* message_;
    QPushButton* copy_;
};

}  // namespace pcm::host
